// The owner of the precompiled standard headers; see CMakeLists.txt.
