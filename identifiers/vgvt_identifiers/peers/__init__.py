"""Adapters to other people's libraries, for the bench to judge them on the same campaigns; none is a dependency."""
