# The devices' side of the sensor-bus: recognition (pure), the readers, a folder a kind, udev.
pkg_check_modules(udev REQUIRED IMPORTED_TARGET libudev)
trb_library(trb_sensor_recognition
            SOURCES
              core/recognition.cpp
              core/unknown_device.cpp
            LIBS trb_fleet)
trb_library(trb_sensor_devices_io
            SOURCES
              io/devices/devices.cpp
              io/devices/reader_thread.cpp
              io/devices/udev_monitor.cpp
            LIBS trb_sensor_recognition trb_sensor_readers trb_service PkgConfig::udev Threads::Threads)
trb_test(test_sensor_recognition LABEL unit SOURCES core/recognition_test.cpp LIBS trb_sensor_recognition trb_config)

# trb_devices_test(NAME SOURCES a_test.cpp ...): with devices that are not there. umockdev answers libudev and shows /sys and
# /dev, in the process that its wrapper starts.
pkg_check_modules(umockdev IMPORTED_TARGET umockdev-1.0)
if(TRB_BUILD_TESTS AND umockdev_FOUND)
  trb_library(trb_sensor_test_machine SOURCES test/machine.cpp
              LIBS trb_sensor_devices_io trb_config PkgConfig::umockdev doctest::doctest)
elseif(TRB_BUILD_TESTS)
  message(STATUS "tests of devices: left out, for umockdev is not there (Debian: umockdev libumockdev-dev)")
endif()
function(trb_devices_test NAME)
  if(TARGET trb_sensor_test_machine)
    cmake_parse_arguments(ARG "" "" "SOURCES" ${ARGN})
    trb_test(${NAME} LABEL unit UNDER umockdev-wrapper SOURCES ${ARG_SOURCES} LIBS trb_sensor_test_machine)
    set_tests_properties(${NAME} PROPERTIES ENVIRONMENT "ASAN_OPTIONS=verify_asan_link_order=0")
  endif()
endfunction()

add_subdirectory(readers)
trb_devices_test(test_sensor_devices SOURCES io/devices/devices_test.cpp)
