"""The page: a skin over store, audit and diagnosis. Needs the extra ``lostmotion[web]``."""
