"""The decision process: actions in; observations, rewards, ends and reports out."""
