# Toolchain: the kernel for another system, compiled by zig, which the Python package `ziglang`
# holds. ZIG is its program, ZIG_TARGET zig's name of the system.
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES ZIG ZIG_TARGET)
set(CMAKE_C_COMPILER ${ZIG} cc)
set(CMAKE_C_COMPILER_TARGET ${ZIG_TARGET})

string(REGEX MATCH "^[^-]+" CMAKE_SYSTEM_PROCESSOR ${ZIG_TARGET})
if(ZIG_TARGET MATCHES "windows")
  set(CMAKE_SYSTEM_NAME Windows)
elseif(ZIG_TARGET MATCHES "macos")
  set(CMAKE_SYSTEM_NAME Darwin)
else()
  set(CMAKE_SYSTEM_NAME Linux)
endif()

# Without symbols; a DLL then has a hash of its content where others have the time of the link.
set(CMAKE_SHARED_LINKER_FLAGS_INIT -s)
# A program to try the compiler with would cost minutes: zig builds C libraries for it.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
# CMake wants one for macOS, and calls none: the install name is right from the start.
set(CMAKE_INSTALL_NAME_TOOL ${ZIG})
