"""Pictures of runs, for tools/plot; `style` also for tools/convergence, tools/tradeoff and tools/bench."""
