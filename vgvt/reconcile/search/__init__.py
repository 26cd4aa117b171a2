"""From thousands of variants of the catalogue to the few that are fitted: grids, screens, starts, short lists."""
