// The limit of the hardware: the closed loop of one HAV per world, in C++ on one thread.
//
// One instruction works on several worlds: arrays are [unit][lane], a lane is a world, units are
// outside and lanes inside, and what a block of lanes needs about fits the first cache. No loop
// over lanes branches or calls a library. What the speed rests on beyond that:
//   - a heading is kept as a unit vector and turned by a small angle: no reduction of angles;
//   - the jackknife weights are added up as one fraction: one division for all joints;
//   - the steering is the tangent that the kinematics need, clipped: no arctangent;
//   - of the six Dubins words only the four with an inner tangent or a third circle take an
//     arctangent. In the others the two turns add up to a known angle or to a full circle more,
//     which comparing directions decides.
// It is meant for -ffast-math: there are no infinities here, and limit.py checks the results. It
// keeps fewer records than hav_env: the first jackknife and the number of goals.
//
//   limit measure TRAILERS BLOCKS STEPS KINEMATICS   TRAILERS 0: the paper's mix; KINEMATICS 0 or 1
//   limit drive                                      one HAV from standard input, see drive()

#include "limit_maths.hpp"

// A step.

void decide(Block& b, const Rules& rules) {  // AVOID-JACK without neighbours
    const double steering_cosine = std::cos(rules.steering_max);
    const double steering_sine = std::sin(rules.steering_max);
    const double steepest = steering_sine / steering_cosine;
    Path best[LANES / WIDTH];
    Goal goal[LANES / WIDTH];
    EVERY_LANE {
        const Many c = b.cosine[0][i], s = b.sine[0][i], gc = b.goal_cosine[i], gs = b.goal_sine[i];
        const Many dx = b.goal_x[i] - b.x[i], dy = b.goal_y[i] - b.y[i];
        const Mask near = dx * dx + dy * dy < b.close_squared[i];
        const Many back = near ? ZERO : b.truck[i];
        const Many k = near ? b.curvature_near[i] : b.curvature_far[i];
        const Many turn = b.goal_heading[i] - b.heading[i];
        const Many cosine = gc * c + gs * s, sine = gs * c - gc * s;
        Many angle = turn - TURN * whole(turn / TURN);
        angle = angle > TURN - ROUNDING ? angle - TURN : angle;
        goal[i] = {k * (dx * c + dy * s - back * cosine), k * (dy * c - dx * s - back * sine),
                   angle, cosine, sine, STRAIGHT_BELOW * k};
        best[i] = {ONE * FAR, ZERO};
    }
    EVERY_LANE {
        const Goal left = goal[i], right = left.reflected();
        const Outer l = left, r = right;
        const Angles half = arctangents(l.across, l.other, r.across, r.other);
        outer(best[i], left, l, half.first, 1);
        outer(best[i], right, r, half.second, -1);
    }
    EVERY_LANE {
        const Goal left = goal[i], right = left.reflected();
        const Inner l = left, r = right;
        const Angles acute = arctangents(size(l.y), size(l.x), size(r.y), size(r.x));
        inner(best[i], left, l, acute.first, 1);
        inner(best[i], right, r, acute.second, -1);
    }
    EVERY_LANE {
        const Many c = b.cosine[0][i], s = b.sine[0][i], side = best[i].side;
        const Many jc = b.cosine[1][i] * c + b.sine[1][i] * s;
        const Many js = b.sine[1][i] * c - b.cosine[1][i] * s;
        const Many n = b.weight_above[i], d = b.weight_below[i];
        const Many ahead = (side == 0. ? ONE : ONE * steering_cosine) * d + n * jc;
        const Many aside = side * steering_sine * d + n * js;
        const Many ratio = aside / (ahead > 0. ? ahead : ONE);
        const Many steep = aside < 0. ? ZERO - steepest : ZERO + steepest;
        b.tangent[i] = ((ahead > 0.) & (size(ratio) < steepest)) ? ratio : steep;
    }
}

template <bool simultaneous>
void move(Block& b) {  // OnAxle: one Euler step
    // Tile by tile: what goes from unit to unit stays in registers.
    for (int begin = 0; begin < LANES / WIDTH; begin += TILE) {
        Many speed[TILE], ahead_cosine[TILE], ahead_sine[TILE];  // speed relative to the truck's
#pragma GCC unroll 8
        for (int k = 0; k < TILE; ++k) {
            const int i = begin + k;
            const Many c = b.cosine[0][i], s = b.sine[0][i], angle = b.rate[0][i] * b.tangent[i];
            const Direction next = turned(c, s, angle);
            b.cosine[0][i] = next.cosine, b.sine[0][i] = next.sine, b.heading[i] += angle;
            ahead_cosine[k] = simultaneous ? c : next.cosine;
            ahead_sine[k] = simultaneous ? s : next.sine;
            speed[k] = ONE;
            b.x[i] += b.travel[i] * ahead_cosine[k];
            b.y[i] += b.travel[i] * ahead_sine[k];
        }
        for (int unit = 1; unit <= b.trailers; ++unit) {
#pragma GCC unroll 8
            for (int k = 0; k < TILE; ++k) {
                const int i = begin + k;
                const Many c = b.cosine[unit][i], s = b.sine[unit][i];
                const Many ac = ahead_cosine[k], as = ahead_sine[k];
                const Many yaw = b.rate[unit][i] * speed[k] * (c * as - s * ac);
                const Direction next = turned(c, s, yaw);
                b.cosine[unit][i] = next.cosine, b.sine[unit][i] = next.sine;
                ahead_cosine[k] = simultaneous ? c : next.cosine;
                ahead_sine[k] = simultaneous ? s : next.sine;
                speed[k] *= ahead_cosine[k] * ac + ahead_sine[k] * as;
            }
        }
    }
}

void weigh(Block& b) {  // sum up the jackknife weights of the joints, record a jackknife
    for (int begin = 0; begin < LANES / WIDTH; begin += TILE) {
        Many above[TILE], below[TILE], least[TILE];
        for (int k = 0; k < TILE; ++k) above[k] = ZERO, below[k] = ONE, least[k] = ONE;
        for (int unit = 1; unit <= b.trailers; ++unit) {
#pragma GCC unroll 8
            for (int k = 0; k < TILE; ++k) {
                const int i = begin + k;
                const Many cosine = b.cosine[unit][i] * b.cosine[unit - 1][i]
                                    + b.sine[unit][i] * b.sine[unit - 1][i];
                const Many e = 1. + exponential(2 * C * cosine - 2 * B);  // the weight is 2 / e
                above[k] = above[k] * e + 2. * below[k];
                below[k] *= e;
                least[k] = smaller(least[k], cosine);
            }
        }
        for (int k = 0; k < TILE; ++k) {
            const int i = begin + k;
            const Mask is_first = (least[k] < 0.) & (b.jackknife_step[i] == NEVER);
            b.jackknife_step[i] = is_first ? b.steps[i] : b.jackknife_step[i];
            b.weight_above[i] = above[k], b.weight_below[i] = below[k];
        }
    }
}

bool score(Block& b) {  // test the goals; return whether any lane needs something new
    const double aligned = std::cos(HEADING_TOLERANCE);
    Many any = ZERO;
    EVERY_LANE {
        const Many dx = b.goal_x[i] - b.x[i], dy = b.goal_y[i] - b.y[i];
        const Many cosine = b.goal_cosine[i] * b.cosine[0][i] + b.goal_sine[i] * b.sine[0][i];
        const Mask near = dx * dx + dy * dy < DISTANCE_TOLERANCE * DISTANCE_TOLERANCE;
        const Many hit = (near & (cosine > aligned)) ? ONE : ZERO;
        b.goals_hit[i] += hit;
        b.done[i] = hit + (b.steps[i] >= MAX_STEPS ? ONE * 2. : ZERO);
        any += b.done[i];
    }
    double sum = 0;
    for (int k = 0; k < WIDTH; ++k) sum += any[k];
    return sum > 0;
}

template <class Renew>
void step(Block& b, const Rules& rules, Renew renew) {  // renew(lane) is called for those done
    decide(b, rules);
    EVERY_LANE b.steps[i] += 1.;
    rules.simultaneous ? move<true>(b) : move<false>(b);
    weigh(b);
    if (!score(b)) return;
    for (int i = 0; i < LANES; ++i)
        if (b.done.lane(i) > 0) renew(i);
}

// What happens rarely, lane by lane.

void set_fleet(Block& b, int i, const std::vector<double>& length, const Rules& rules) {
    const double truck = length[0], swing = std::sin(BETA) / length[1];
    const double safe = (PI / 2 - BETA) / (DT * (swing + std::tan(rules.steering_max) / truck));
    b.travel.lane(i) = DT * std::min(1., safe);
    double squares = 0;
    for (int unit = 0; unit <= b.trailers; ++unit) {
        b.rate[unit].lane(i) = b.travel.lane(i) / length[unit];
        squares += length[unit] * length[unit];
    }
    b.truck.lane(i) = truck;
    b.curvature_near.lane(i) = 1 / truck, b.curvature_far.lane(i) = 1 / std::sqrt(squares);
    b.close_squared.lane(i) = rules.close_factor * truck * rules.close_factor * truck;
    b.jackknife_step.lane(i) = NEVER, b.goals_hit.lane(i) = 0;
}

void set_start(Block& b, int i, double x, double y, double heading) {
    b.x.lane(i) = x, b.y.lane(i) = y, b.heading.lane(i) = heading, b.steps.lane(i) = 0;
    for (int unit = 0; unit <= b.trailers; ++unit)
        b.cosine[unit].lane(i) = std::cos(heading), b.sine[unit].lane(i) = std::sin(heading);
}

void set_goal(Block& b, int i, double x, double y, double heading) {
    b.goal_x.lane(i) = x, b.goal_y.lane(i) = y, b.goal_heading.lane(i) = heading;
    b.goal_cosine.lane(i) = std::cos(heading), b.goal_sine.lane(i) = std::sin(heading);
}

// Measure: the fleets of RandomPoses, a new goal for who hits one, a new start after MAX_STEPS.
void measure(int trailers, int num_blocks, int num_steps, bool kinematics_alone) {
    const Rules rules;
    std::mt19937_64 random(0);
    std::uniform_real_distribution<double> unit_interval(0, 1);
    std::normal_distribution<double> short_truck(4, 0.6), long_truck(10.7, 1.2);
    auto uniform = [&](double low, double high) {
        return low + (high - low) * unit_interval(random);
    };
    std::vector<Block> blocks(num_blocks);
    std::vector<std::vector<double>> sides(num_blocks, std::vector<double>(LANES));
    auto draw_goal = [&](int k, int i) {
        const double side = sides[k][i];
        set_goal(blocks[k], i, uniform(0, side), uniform(0, side), uniform(0, TURN));
    };
    auto draw_start = [&](int k, int i) {
        const double side = sides[k][i];
        set_start(blocks[k], i, uniform(0, side), uniform(0, side), uniform(0, TURN));
    };
    for (int k = 0; k < num_blocks; ++k) {
        Block& b = blocks[k];  // the blocks' trailer counts: evenly spaced quantiles
        const int count = int(3 * std::sqrt(-2 * std::log(1 - (k + 0.5) / num_blocks)));
        b.trailers = trailers > 0 ? trailers : std::min(std::max(count, 1), UNITS - 1);
        for (int i = 0; i < LANES; ++i) {
            std::vector<double> length(b.trailers + 1);
            const bool is_short = uniform(0, 1) < 0.5;
            do length[0] = is_short ? short_truck(random) : long_truck(random);
            while (length[0] < 2 || length[0] >= 12);
            double footprint = 0;
            for (int unit = 1; unit <= b.trailers; ++unit)
                footprint += length[unit] = uniform(2, 12);
            sides[k][i] = std::sqrt(4 * PI) * footprint;
            set_fleet(b, i, length, rules);
            draw_start(k, i), draw_goal(k, i);
            b.tangent.lane(i) = uniform(-0.05, 0.05);  // for the kinematics alone
        }
        weigh(b);
    }
    const auto begin = std::chrono::steady_clock::now();
    for (int k = 0; k < num_blocks; ++k) {
        Block& b = blocks[k];
        for (int t = 0; t < num_steps; ++t) {
            if (kinematics_alone) {
                move<false>(b);
                continue;
            }
            step(b, rules, [&](int i) {
                if (b.done.lane(i) >= 2) draw_start(k, i);
                draw_goal(k, i), b.steps.lane(i) = 0;
            });
        }
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    double goals = 0, jackknifed = 0, sum = 0;  // the sum: nothing may be optimised away
    for (Block& b : blocks)
        for (int i = 0; i < LANES; ++i) {
            goals += b.goals_hit.lane(i), jackknifed += b.jackknife_step.lane(i) != NEVER;
            sum += b.x.lane(i) + b.y.lane(i) + b.cosine[b.trailers].lane(i);
        }
    const double worlds = double(num_blocks) * LANES;
    std::printf("{\"rate\": %.6g, \"goals\": %.0f, \"jackknifed\": %.5f, \"sum\": %.17g}\n",
                worlds * num_steps / seconds.count(), goals, jackknifed / worlds, sum);
}

// Drive one HAV from goal to goal and print where it ends. Standard input: steps, steering_max,
// close_factor, simultaneous; number of units, their lengths; start; number of goals, the goals.
void drive() {
    Rules rules;
    auto number = [] {
        double value = 0;
        if (std::scanf("%lf", &value) != 1) std::exit(2);
        return value;
    };
    const int num_steps = int(number());
    rules.steering_max = number(), rules.close_factor = number();
    rules.simultaneous = number() != 0;
    auto block = std::make_unique<Block>();
    Block& b = *block;
    auto numbers = [&](double count) {
        std::vector<double> values;
        while (values.size() < count) values.push_back(number());
        return values;
    };
    const std::vector<double> length = numbers(number());
    b.trailers = int(length.size()) - 1;
    const double x = number(), y = number(), heading = number();
    const std::vector<double> goals = numbers(3 * number());
    for (int i = 0; i < LANES; ++i) {  // every lane the same
        set_fleet(b, i, length, rules);
        set_start(b, i, x, y, heading);
        set_goal(b, i, goals[0], goals[1], goals[2]);
    }
    weigh(b);
    for (int t = 0; t < num_steps && b.goals_hit.lane(0) < goals.size() / 3; ++t)
        step(b, rules, [&](int i) {
            const std::size_t next = 3 * std::size_t(b.goals_hit.lane(i));
            if (next < goals.size()) set_goal(b, i, goals[next], goals[next + 1], goals[next + 2]);
        });
    const int lane = LANES - 1;
    std::printf("{\"x\": %.17g, \"y\": %.17g, \"headings\": [%.17g", b.x.lane(lane), b.y.lane(lane),
                b.heading.lane(lane));
    for (int unit = 1; unit <= b.trailers; ++unit)
        std::printf(", %.17g", std::atan2(b.sine[unit].lane(lane), b.cosine[unit].lane(lane)));
    std::printf("], \"goals_hit\": %.0f, \"jackknife_step\": %.0f}\n", b.goals_hit.lane(lane),
                b.jackknife_step.lane(lane));
}

int main(int count, char** words) {
    if (count == 2 && !std::strcmp(words[1], "drive"))
        drive();
    else if (count == 6 && !std::strcmp(words[1], "measure"))
        measure(std::atoi(words[2]), std::atoi(words[3]), std::atoi(words[4]), std::atoi(words[5]));
    else
        return 2;
}
