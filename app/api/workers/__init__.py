"""Worker processes of jobs, on this machine or a cluster: a crash ends the job of one file only."""
