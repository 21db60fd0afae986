"""Fatigue safety of a throw: fillets, outlets, rounded edges, by local stress and by rule."""
