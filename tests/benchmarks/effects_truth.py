"""The closed-form estimates of the effects plan against finite elements, on four engines.

Run with `python -m tests.benchmarks.effects_truth`; what is computed: `tests.studies.effect_truths`.
"""

from __future__ import annotations

from cranktopo.numerics.precision import double_precision
from tests.studies.effect_truths import estimates, scenes, truths


def main() -> None:
    """Print the table as Markdown."""
    print("| engine | effect | estimate % | computed % | ratio |")
    print("|---|---|---|---|---|")
    with double_precision():
        for scene in scenes():
            computed, estimated = truths(scene), estimates(scene)
            for name, truth in computed.items():
                estimate = estimated.get(name)
                if estimate is not None and truth > 1e-9:
                    row = f"{estimate:.3g} | {truth:.3g} | {estimate / truth:.2f}"
                    print(f"| {scene.name} | {name} | {row} |", flush=True)


if __name__ == "__main__":
    main()
