"""Code that tests of several folders share: arms, pages, hand-made documents."""
