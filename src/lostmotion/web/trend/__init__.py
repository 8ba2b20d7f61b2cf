"""The zoomable trend: columns on the disk, what is drawn of them, how."""
