// The owner of the precompiled header of all test programs.
