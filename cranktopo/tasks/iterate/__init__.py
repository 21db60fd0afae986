"""The loop: remove a little, extract, re-model, evaluate; the re-modelled solid bounds the next step."""
