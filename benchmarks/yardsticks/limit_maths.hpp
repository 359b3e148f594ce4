// Lanes, elementary functions and Dubins paths of limit.cpp, for one instruction on several worlds.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

#if defined __AVX512F__  // WIDTH: lanes of one instruction
#define WIDTH 8
#elif defined __AVX__
#define WIDTH 4
#else
#define WIDTH 2
#endif

constexpr int LANES = 128, UNITS = 11, NEVER = -1;
constexpr int TILE = 4;  // instructions' lanes that go through the units together
constexpr double PI = 3.14159265358979323846, TURN = 2 * PI, FAR = 1e9;
constexpr double ROUNDING = 1e-12;  // what rounding leaves of a zero angle [rad]
constexpr double DT = 0.2, DISTANCE_TOLERANCE = 0.5, HEADING_TOLERANCE = 0.1;  // of the Task
constexpr double B = 0.5, C = 2, STRAIGHT_BELOW = 1e-3, BETA = 75 * PI / 180;  // of AvoidJack
constexpr double MAX_STEPS = 20'000;

#define INLINE inline __attribute__((always_inline))
#define EVERY_LANE for (int i = 0; i < LANES / WIDTH; ++i)

typedef double Many __attribute__((vector_size(WIDTH * sizeof(double))));  // lanes at once
typedef decltype(Many() < Many()) Mask;

struct Row {
    Many many[LANES / WIDTH];
    Many& operator[](int i) { return many[i]; }
    double& lane(int i) { return reinterpret_cast<double*>(many)[i]; }  // a lane alone
};

struct Rules {
    double steering_max = 40 * PI / 180, close_factor = 3.5;
    bool simultaneous = false;  // explicit Euler instead of one variable after the other
};

struct Block {
    int trailers;
    Row x, y, heading;               // of the truck [m, rad]
    Row cosine[UNITS], sine[UNITS];  // of the headings of all units
    Row travel, rate[UNITS];         // way of a step [m], and over the unit's length [rad]
    Row truck, curvature_near, curvature_far, close_squared;  // [m, 1/m, 1/m, m^2]
    Row goal_x, goal_y, goal_heading, goal_cosine, goal_sine;
    Row weight_above, weight_below;  // the sum of jackknife weights, a fraction
    Row tangent;                     // of the steering angle
    Row steps, jackknife_step, goals_hit, done;  // done: goal hit (1) and time over (2)
};

// Elementary functions in double precision, for the ranges that occur.

const Many ZERO = {}, ONE = ZERO + 1.;

INLINE Many smaller(Many a, Many b) { return a < b ? a : b; }
INLINE Many larger(Many a, Many b) { return a > b ? a : b; }
INLINE Many size(Many a) { return larger(a, -a); }

INLINE Many root(Many a) {
    for (int k = 0; k < WIDTH; ++k) a[k] = std::sqrt(a[k]);
    return a;
}

INLINE Many whole(Many a) {
    for (int k = 0; k < WIDTH; ++k) a[k] = std::floor(a[k]);
    return a;
}

struct Direction {
    Many cosine, sine;
};

INLINE Direction turned(Many cosine, Many sine, Many angle) {  // |angle| <= 0.13
    const Many z = angle * angle;
    const Many s = angle * (1. + z * (-1. / 6 + z * (1. / 120 + z * (-1. / 5040 + z / 362880.))));
    const Many versine = z * (0.5 + z * (-1. / 24 + z * (1. / 720 - z / 40320.)));
    return {cosine - (cosine * versine + sine * s), sine - (sine * versine - cosine * s)};
}

INLINE Many exponential(Many x) {  // |x| <= 5: the 16th power of a series
    const Many r = x / 16.;
    double factorial = 479'001'600;  // of 12
    Many p = ZERO + 1 / factorial;
    for (int k = 12; k > 0; --k) factorial /= k, p = p * r + 1 / factorial;
    p *= p, p *= p, p *= p;
    return p * p;
}

struct Fraction {
    Many above, below;
};

INLINE Fraction tangent(Many y, Many x) {  // of an angle in [0, pi/2], reduced to [-pi/8, pi/8]
    const Many low = smaller(x, y), high = larger(x, y) + 1e-300;
    const Mask beyond = low > 0.41421356237309503 * high;  // tan(pi/8)
    return {beyond ? low - high : low, beyond ? low + high : high};
}

INLINE Many arctangent(Many y, Many x, Many reduced) {  // [rad] in [0, pi/2]
    const Many t = reduced, z = t * t, low = smaller(x, y), high = larger(x, y);
    Many p = z * 0.02275052699336167 - 0.04483334622272886;
    p = p * z + 0.05736332165907643, p = p * z - 0.06649613695291669;
    p = p * z + 0.0769105515839315, p = p * z - 0.09090852557176049;
    p = p * z + 0.11111109636534361, p = p * z - 0.1428571426609662;
    p = p * z + 0.19999999999898407, p = p * z - 0.3333333333333325;
    const Many bent = low > 0.41421356237309503 * high ? ONE * (PI / 4) : ZERO;
    const Many angle = t + t * z * p + bent;
    return x < y ? PI / 2 - angle : angle;
}

struct Angles {
    Many first, second;
};

// Two angles at once, which share a division.
INLINE Angles arctangents(Many y, Many x, Many other_y, Many other_x) {
    const Fraction one = tangent(y, x), two = tangent(other_y, other_x);
    const Many inverse = 1. / (one.below * two.below);
    return {arctangent(y, x, one.above * two.below * inverse),
            arctangent(other_y, other_x, two.above * one.below * inverse)};
}

INLINE Many positive_turn(Many angle) {  // by a turn where it is below zero by more than rounding
    return angle < -ROUNDING ? angle + TURN : angle;
}

// Dubins: the side to which the shortest path starts, as in hav_env/dubins.py. Lengths in radii.

struct Path {
    Many length, side;
};

struct Goal {  // in the frame of the start; the heading, a bit below zero or positive
    Many x, y, heading, cosine, sine, threshold;
    INLINE Goal reflected() const {
        return {x, -y, positive_turn(-heading), cosine, -sine, threshold};
    }
};

INLINE void keep_shorter(Path& best, Path other, double hand) {
    const Mask better = other.length < best.length;
    best.length = smaller(best.length, other.length);
    best.side = better ? hand * other.side : best.side;
}

// Whether the direction (x, y) is farther left than the one at `angle`, both in [0, 2 pi).
INLINE Mask passes(Many x, Many y, Many size, Many angle, Many cosine, Many sine) {
    const Many across = cosine * y - sine * x;
    const Mask angle_below = angle >= PI, below = y < smaller(-ROUNDING * x, ZERO);
    const Many if_below = angle_below ? across : ONE, if_above = angle_below ? -ONE : across;
    return (below ? if_below : if_above) > ROUNDING * size;
}

INLINE Mask almost_ahead(Many x, Many y, Many threshold) {
    return (y < threshold * x) & (y > -ROUNDING * x);
}

struct Outer {  // from the centre of the start's left circle to that of the goal's
    Many x, y, squared, across, other;
    INLINE Outer(const Goal& goal) : x(goal.x - goal.sine), y(goal.y + goal.cosine - 1.) {
        squared = x * x + y * y, across = root(squared);
        other = root(larger(16. - squared, ZERO));  // twice the height of the third circle
    }
};

INLINE void outer(Path& best, const Goal& goal, const Outer& o, Many half, double hand) {
    // LSL; by reflection RSR
    const Mask more = (o.across >= ROUNDING)
                      & passes(o.x, o.y, o.across, goal.heading, goal.cosine, goal.sine);
    const Many turns = goal.heading + (more ? ONE * TURN : ZERO);
    const Mask no_turn = (o.across >= goal.threshold) | (turns < goal.threshold);
    const Many side = (almost_ahead(o.x, o.y, goal.threshold) & no_turn) ? ZERO : ONE;
    keep_shorter(best, {turns + o.across, side}, hand);
    // LRL; by reflection RLR
    // its first turn ends in the direction (x, y); the second is 2 pi - 2 half
    const Many x = -(o.x * o.other + o.y * o.across), y = o.x * o.across - o.y * o.other;
    const Many cosine = 1. - 0.125 * o.squared, sine = -0.125 * o.across * o.other;
    const Many sum = positive_turn(goal.heading - 2. * half);
    const Mask again = passes(x, y, o.across, sum, goal.cosine * cosine - goal.sine * sine,
                              goal.sine * cosine + goal.cosine * sine);
    const Many length = TURN - 2. * half + sum + (again ? ONE * TURN : ZERO);
    keep_shorter(best, {o.squared > 16. ? ONE * FAR : length,
                        almost_ahead(x, y, goal.threshold) ? -ONE : ONE}, hand);
}

struct Inner {  // the straight of LSR: its length squared, its length, its direction
    Many squared, length, x, y;
    INLINE Inner(const Goal& goal) {
        const Many ax = goal.x + goal.sine, ay = goal.y - goal.cosine - 1.;
        squared = ax * ax + ay * ay - 4., length = root(larger(squared, ZERO));
        x = ax * length - 2. * ay, y = ay * length + 2. * ax;
    }
};

INLINE void inner(Path& best, const Goal& goal, const Inner& straight, Many acute, double hand) {
    const Many half = straight.x < 0. ? PI - acute : acute;
    const Many first = positive_turn(straight.y < 0. ? -half : half);
    const Many last = positive_turn(first - goal.heading);
    const Mask no_turn = (straight.length >= goal.threshold) | (last < goal.threshold);
    const Many then = no_turn ? ZERO : -ONE;
    const Many length = first + straight.length + last;
    keep_shorter(best, {straight.squared < -ROUNDING ? ONE * FAR : length,
                        first >= goal.threshold ? ONE : then}, hand);
}

