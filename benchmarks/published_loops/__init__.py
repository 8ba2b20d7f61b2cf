"""Control loops after published papers on stiction and backlash, and how their diagnosis is judged."""
