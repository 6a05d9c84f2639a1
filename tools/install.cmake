# What `cmake --install` leaves: the program; the library, which is one archive of all rooms, with their
# headers; what find_package(leviosim) reads, with the targets leviosim::leviosim and leviosim::program;
# and tools. Components: program, library, and python with the preset python. `cpack -G DEB` makes a
# Debian package of each.
#   leviosim_install_library(ROOM_LIBRARY...)
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Before what is not built yet is missed: what to build.
function(leviosim_install_needs target component)
  list(JOIN ARGN " " targets)
  install(CODE "
    if(NOT EXISTS \"$<TARGET_FILE:${target}>\")
      message(FATAL_ERROR \"${target} is not built; what builds what is installed:\n\"
        \"  cmake --build ${CMAKE_BINARY_DIR} --target ${targets}\")
    endif()" COMPONENT ${component})
endfunction()

# What the program says of its own command line, when it is installed.
function(leviosim_install_manual format folder name)
  set(file ${CMAKE_BINARY_DIR}/manual/${format}/${name})
  install(CODE "
    file(MAKE_DIRECTORY \"${CMAKE_BINARY_DIR}/manual/${format}\")
    execute_process(COMMAND \"$<TARGET_FILE:leviosim>\" help --as ${format}
                    OUTPUT_FILE \"${file}\" COMMAND_ERROR_IS_FATAL ANY)" COMPONENT program)
  install(FILES ${file} DESTINATION ${folder} COMPONENT program)
endfunction()

function(leviosim_install_library)
  set(objects "")
  foreach(library IN LISTS ARGN)
    list(APPEND objects $<TARGET_OBJECTS:${library}>)
  endforeach()
  add_library(leviosim_library STATIC ${objects})
  set_target_properties(leviosim_library PROPERTIES
    OUTPUT_NAME leviosim EXPORT_NAME leviosim LINKER_LANGUAGE CXX
    ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/library)
  # As leviosim itself is compiled: counts and results must not depend on who compiles a kernel.
  target_compile_features(leviosim_library INTERFACE cxx_std_20)
  target_compile_options(leviosim_library INTERFACE -ffp-contract=off)
  target_include_directories(leviosim_library SYSTEM INTERFACE
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/leviosim>)
  target_link_libraries(leviosim_library INTERFACE
    fmt::fmt Eigen3::Eigen nlohmann_json::nlohmann_json CLI11::CLI11 OpenSSL::Crypto
    PNG::PNG ZLIB::ZLIB zstd::libzstd_shared yaml jpeg opencv_imgproc opencv_core)
  set_target_properties(leviosim PROPERTIES EXPORT_NAME program)

  leviosim_install_needs(leviosim program leviosim)
  leviosim_install_needs(leviosim_library library leviosim leviosim_library)
  install(TARGETS leviosim EXPORT leviosim RUNTIME COMPONENT program)
  install(PROGRAMS tools/rosbag_to_asl.py RENAME leviosim-bag-to-asl COMPONENT program
          DESTINATION ${CMAKE_INSTALL_BINDIR})
  leviosim_install_manual(man ${CMAKE_INSTALL_MANDIR}/man1 leviosim.1)
  leviosim_install_manual(bash ${CMAKE_INSTALL_DATADIR}/bash-completion/completions leviosim)
  leviosim_install_manual(zsh ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions _leviosim)
  leviosim_install_manual(fish ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d leviosim.fish)
  install(TARGETS leviosim_library EXPORT leviosim ARCHIVE COMPONENT library)
  install(DIRECTORY sim workload platform_models traces DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/leviosim
          COMPONENT library FILES_MATCHING PATTERN "*.h")
  install(DIRECTORY tools/app tools/commands DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/leviosim/tools
          COMPONENT library FILES_MATCHING PATTERN "*.h")
  install(PROGRAMS tools/check_counting.py RENAME leviosim-check-counting COMPONENT library
          DESTINATION ${CMAKE_INSTALL_BINDIR})
  # leviosim-measure finds what it compiles beside itself.
  set(share ${CMAKE_INSTALL_DATADIR}/leviosim)
  install(DIRECTORY tools/rv32 DESTINATION ${share}/tools COMPONENT library USE_SOURCE_PERMISSIONS
          FILES_MATCHING PATTERN "*.h" PATTERN "*.cpp" PATTERN "*.py" PATTERN "*.mk" PATTERN "Makefile"
          PATTERN "rv32imfc_costs.csv")
  install(DIRECTORY sim/work DESTINATION ${share}/sim COMPONENT library FILES_MATCHING PATTERN "*.cpp")
  install(FILES sim/base/nearest_name.cpp DESTINATION ${share}/sim/base COMPONENT library)
  install(DIRECTORY platform_models/isa DESTINATION ${share}/platform_models COMPONENT library
          FILES_MATCHING PATTERN "*.yaml")
  install(CODE "
    set(folder \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}\")
    file(MAKE_DIRECTORY \"\${folder}\")
    file(CREATE_LINK ../${share}/tools/rv32/measure_kernels.py \"\${folder}/leviosim-measure\" SYMBOLIC)"
    COMPONENT library)
  install(FILES tools/leviosim.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/leviosim COMPONENT library)
  install(DIRECTORY tests/examples/outside COMPONENT library
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libleviosim-dev/examples)

  set(package ${CMAKE_INSTALL_LIBDIR}/cmake/leviosim)
  install(EXPORT leviosim NAMESPACE leviosim:: FILE leviosim-targets.cmake DESTINATION ${package}
          COMPONENT library)
  configure_package_config_file(tools/leviosim-config.cmake.in
    ${CMAKE_BINARY_DIR}/library/leviosim-config.cmake INSTALL_DESTINATION ${package})
  write_basic_package_version_file(${CMAKE_BINARY_DIR}/library/leviosim-config-version.cmake
    COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_BINARY_DIR}/library/leviosim-config.cmake
                ${CMAKE_BINARY_DIR}/library/leviosim-config-version.cmake
          DESTINATION ${package} COMPONENT library)
endfunction()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME leviosim)
set(CPACK_PACKAGE_VENDOR leviosim)
set(CPACK_PACKAGE_CONTACT "the maintainers of leviosim")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL program library)
if(LEVIOSIM_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME leviosim)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "python3, lz4, zstd") # leviosim-bag-to-asl
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
    "Runs visual-inertial odometry on models of ultra-low-power multicore chips")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libleviosim-dev)
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "leviosim as a library, for workloads and kernels of your own")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS
    "leviosim (= ${PROJECT_VERSION}), g++, cmake, make, python3, libeigen3-dev, libfmt-dev, \
libpng-dev, libjpeg62-turbo-dev, libopencv-imgproc-dev, libyaml-dev, nlohmann-json3-dev, libcli11-dev, libssl-dev, libzstd-dev, zlib1g-dev")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SUGGESTS # leviosim-check-counting, leviosim-measure
    "clang-tools, gcc-riscv64-unknown-elf, picolibc-riscv64-unknown-elf, gcc-arm-none-eabi, \
libnewlib-arm-none-eabi, libcapstone-dev, qemu-user")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-leviosim)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "leviosim as a Python module")
include(CPack)
