"""What does the build of the documentation add to Sphinx?"""
