"""The HTTP service: routers per noun under ``/api/v1``, and what stands before and behind them."""
