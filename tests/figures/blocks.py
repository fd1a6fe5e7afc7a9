"""A mesh that several tests use."""


def two_blocks(lower):
    """GRIDs and CQUAD4s of a block (1 to 27) that lies on a wider one (101 to 165, with the property `lower`)."""
    text = ""
    for first, x0, y0, across, up in (1, 0.0, 0.0, 8, 2), (101, -1.0, -2.0, 12, 4):
        for j in range(up + 1):
            for i in range(across + 1):
                n = first + i + j * (across + 1)
                text += f"GRID,{n},,{x0 + 0.5 * i},{y0 + 0.5 * j}\n"
                if i < across and j < up:
                    text += f"CQUAD4,{n},{1 if first == 1 else lower},{n},{n + 1},{n + across + 2},{n + across + 1}\n"
    return text
