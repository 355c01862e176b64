"""What the methods and levels of detail cost, where they fail, and what they agree with."""
