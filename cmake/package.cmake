# The installed package: `cmake --install build/release --component sdk --prefix DIR`, then find_package(talkrobots) gives
# talkrobots::service. What of it is public, and how it is used: common/service/README.md.
# `--component node` has what a node runs, with the examples of its files; `ros` the bridge to ROS and the virtual robot on ROS,
# `cloud` the gateway, `virtual-robots` the robots without hardware (trb_install_program). A component is a package of Debian:
# scripts/package.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(SDK_INCLUDES ${CMAKE_INSTALL_INCLUDEDIR}/talkrobots)
set(SDK_CMAKE ${CMAKE_INSTALL_LIBDIR}/cmake/talkrobots)
# service, and what it is linked from. Only the headers of base, proto and actor are public besides its own.
foreach(PART base proto actor fleet ranking security config log transport service)
  set_target_properties(trb_${PART} PROPERTIES EXPORT_NAME ${PART})
  install(TARGETS trb_${PART} EXPORT talkrobotsTargets COMPONENT sdk DESTINATION ${CMAKE_INSTALL_LIBDIR}
          INCLUDES DESTINATION ${SDK_INCLUDES})
endforeach()
target_compile_features(trb_base INTERFACE cxx_std_20)

install(DIRECTORY proto DESTINATION ${SDK_INCLUDES} COMPONENT sdk FILES_MATCHING PATTERN *.hpp)
install(DIRECTORY common/base common/actor DESTINATION ${SDK_INCLUDES}/common COMPONENT sdk FILES_MATCHING PATTERN *.hpp
        PATTERN test EXCLUDE)
install(FILES common/service/service.hpp common/service/version.hpp DESTINATION ${SDK_INCLUDES}/common/service COMPONENT sdk)
install(FILES common/service/README.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT sdk)

install(EXPORT talkrobotsTargets NAMESPACE talkrobots:: DESTINATION ${SDK_CMAKE} COMPONENT sdk)
configure_package_config_file(cmake/talkrobotsConfig.cmake.in ${CMAKE_BINARY_DIR}/cmake/talkrobotsConfig.cmake
                              INSTALL_DESTINATION ${SDK_CMAKE})
# Below 1.0 a minor version may break what is built against it.
write_basic_package_version_file(${CMAKE_BINARY_DIR}/cmake/talkrobotsConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/cmake/talkrobotsConfig.cmake ${CMAKE_BINARY_DIR}/cmake/talkrobotsConfigVersion.cmake
        DESTINATION ${SDK_CMAKE} COMPONENT sdk)

install(DIRECTORY config DESTINATION ${CMAKE_INSTALL_DATADIR}/talkrobots COMPONENT node)
install(FILES README.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT node)
# For whoever works in a hall without network.
install(DIRECTORY deploy/handbook DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT node)
# The node as a service of systemd, its user, and who may own its names on D-Bus.
install(FILES deploy/systemd/talkrobots.service deploy/systemd/talkrobots-sensor-bus.service COMPONENT node
        DESTINATION lib/systemd/system)
install(FILES deploy/systemd/talkrobots.sysusers RENAME talkrobots.conf COMPONENT node DESTINATION lib/sysusers.d)
install(FILES deploy/dbus/trbots.conf COMPONENT node DESTINATION ${CMAKE_INSTALL_DATADIR}/dbus-1/system.d)
# What shells and man know of trb; not there where trb could not run (built for arm64 without an emulator).
set(CLI ${CMAKE_BINARY_DIR}/services/cli)
install(FILES ${CLI}/trb.bash RENAME trb OPTIONAL COMPONENT node
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${CLI}/trb.zsh RENAME _trb OPTIONAL COMPONENT node DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
install(FILES ${CLI}/trb.fish OPTIONAL COMPONENT node DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(FILES ${CLI}/trb.1 OPTIONAL COMPONENT node DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
