"""Charts as inline SVG: text at its own size whatever the width, colours by class, all text escaped."""
