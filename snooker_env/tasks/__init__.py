"""What is played? Strokes of visits and frames on one table or many: actions, errors of execution, rules, observations and rewards."""
