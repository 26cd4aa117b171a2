"""What a test could tell: sizes that it would see, and changes of procedure or readings that tell two names apart."""
