"""The concealed benchmark: a plant of its own kind hides effects, and the diagnosis must name them.

Nothing here knows the catalogue's terms: the plant is made of a shaft, wires, springs, slip
elements and a camera, integrated in time.
"""
