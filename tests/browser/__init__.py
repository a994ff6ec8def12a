"""Widgets and exported pages, tested in a real browser.

A package, so that its server and its browser stop when its last test ends: playwright keeps an event loop
running in this thread, and nbval's notebooks, which come after, would stumble over it.
"""
