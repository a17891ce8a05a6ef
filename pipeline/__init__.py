"""loopgap: record, model, compensate and explain hysteresis loops of wire-driven robots."""
