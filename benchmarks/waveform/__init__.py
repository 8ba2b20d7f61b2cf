"""The networks of the waveform index: simulated loops to learn from, what the networks see, their training.

Needs PyTorch and a GPU, which the project does not; what comes out is ``src/lostmotion/diagnose/waveform.npz``.
"""
