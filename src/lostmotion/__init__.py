"""Lost motion of industrial actuators."""
