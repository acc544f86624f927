# The devices' side of the sensor-bus: recognition and parsers (pure), udev and readers.
pkg_check_modules(udev REQUIRED IMPORTED_TARGET libudev)
pkg_check_modules(jpeg REQUIRED IMPORTED_TARGET libjpeg)
trb_library(trb_sensor_devices_core SOURCES core/nmea.cpp core/recognition.cpp core/tag_keys.cpp core/unknown_device.cpp core/values.cpp
            LIBS trb_fleet)
trb_library(trb_sensor_jpeg SOURCES core/jpeg.cpp LIBS trb_base PkgConfig::jpeg)
trb_library(trb_sensor_devices_io SOURCES io/devices/attributes.cpp io/devices/camera.cpp io/devices/reader_pool.cpp io/devices/devices.cpp
            io/devices/keyboard.cpp io/devices/reader.cpp io/devices/serial.cpp io/devices/udev_monitor.cpp
            LIBS trb_sensor_devices_core trb_sensor_jpeg trb_service PkgConfig::udev Threads::Threads)
trb_test(test_sensor_recognition LABEL unit SOURCES core/recognition_test.cpp core/values_test.cpp LIBS trb_sensor_devices_core trb_config)
trb_test(test_sensor_jpeg LABEL unit SOURCES core/jpeg_test.cpp LIBS trb_sensor_jpeg)

# Devices that are not there: umockdev answers libudev and shows /sys and /dev, in the process that its wrapper starts.
pkg_check_modules(umockdev IMPORTED_TARGET umockdev-1.0)
if(TRB_BUILD_TESTS AND umockdev_FOUND)
  trb_test(test_sensor_devices LABEL unit UNDER umockdev-wrapper SOURCES io/devices/devices_test.cpp
           LIBS trb_sensor_devices_io trb_config PkgConfig::umockdev)
  set_tests_properties(test_sensor_devices PROPERTIES ENVIRONMENT "ASAN_OPTIONS=verify_asan_link_order=0")
elseif(TRB_BUILD_TESTS)
  message(STATUS "test_sensor_devices: left out, for umockdev is not there (Debian: umockdev libumockdev-dev)")
endif()
