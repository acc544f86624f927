# Cross-compiles for 64-bit ARM (Raspberry Pi and the like) on Debian 12:
#   dpkg --add-architecture arm64 && apt-get update
#   apt-get install g++-aarch64-linux-gnu libzmq3-dev:arm64 libsodium-dev:arm64 libsqlite3-dev:arm64 libspdlog-dev:arm64 \
#     libmd-dev:arm64 libmodbus-dev:arm64 libsdbus-c++-dev:arm64 libudev-dev:arm64 libsystemd-dev:arm64 libjpeg62-turbo-dev:arm64 libssl-dev:arm64 \
#     libpqxx-dev:arm64 zlib1g-dev:arm64
#   cmake --preset arm64 && cmake --build --preset arm64
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(ENV{PKG_CONFIG_LIBDIR} /usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
