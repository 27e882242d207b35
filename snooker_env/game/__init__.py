"""Snooker itself: balls, rules, frames and layouts, without physics and without Gymnasium."""
