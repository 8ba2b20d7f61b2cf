"""What runs an audit: plan, batches, engines, versions of the code; nothing about valves."""
