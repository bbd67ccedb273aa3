# SPDX-License-Identifier: Apache-2.0
# The VTK modules and their Python package. Included at the top, so that all rooms see the toolkit's targets.

# Found the same way by our build and by the users of the installed package.
if(ANAMORPH_TOOLKIT STREQUAL "PARAVIEW")
    set(find_toolkit "find_package(ParaView REQUIRED COMPONENTS RemotingCore RemotingServerManager RemotingViews)")
else()
    set(find_toolkit "find_package(VTK 9.1 REQUIRED COMPONENTS CommonExecutionModel FiltersCore FiltersGeneral
             FiltersGeometry FiltersModeling FiltersSources IOCore IOGeometry IOImage ImagingCore ParallelCore RenderingOpenGL2 WrappingPythonCore Python)")
endif()
file(WRITE ${PROJECT_BINARY_DIR}/AnamorphToolkit.cmake "# SPDX-License-Identifier: Apache-2.0\n${find_toolkit}\n")
include(${PROJECT_BINARY_DIR}/AnamorphToolkit.cmake)
install(FILES ${PROJECT_BINARY_DIR}/AnamorphToolkit.cmake DESTINATION ${package_dir} COMPONENT development)
# What the example, anamorph-view and anamorph-warp take beyond that. It is found here, and not in their folders alone: the packages that VTK
# finds for it (MPI) have to be known where VTK's own targets are, or nothing is generated.
if(ANAMORPH_TOOLKIT STREQUAL "VTK" AND (ANAMORPH_TESTS OR ANAMORPH_VIEWER))
    find_package(VTK 9.1 REQUIRED COMPONENTS InteractionStyle RenderingFreeType)
endif()

# One folder of libraries: a plugin then finds the modules from the build tree as from an installation.
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR})
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR})
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_BINDIR})

vtk_module_find_modules(module_files ${PROJECT_SOURCE_DIR}/vtk_filters)
vtk_module_scan(MODULE_FILES ${module_files}
                PROVIDES_MODULES anamorph_modules
                REQUIRES_MODULES required_modules
                HIDE_MODULES_FROM_CACHE ON
                WANT_BY_DEFAULT ON)
foreach(module IN LISTS required_modules)
    if(NOT TARGET ${module})
        message(FATAL_ERROR "ANAMORPH_TOOLKIT=${ANAMORPH_TOOLKIT}: its module ${module} is missing")
    endif()
endforeach()
# Those of a ParaView are called like its own, so that they can be installed beside VTK's.
set(module_names VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
if(ANAMORPH_TOOLKIT STREQUAL "PARAVIEW")
    list(APPEND module_names LIBRARY_NAME_SUFFIX pv${ParaView_VERSION_MAJOR}.${ParaView_VERSION_MINOR})
endif()
vtk_module_build(MODULES ${anamorph_modules}
                 ${module_names}
                 PACKAGE AnamorphVTK
                 INSTALL_EXPORT AnamorphVTK
                 CMAKE_DESTINATION ${package_dir}
                 HEADERS_DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/anamorph/vtk
                 USE_EXTERNAL OFF)
# Half of the time to compile what stands on VTK goes into its headers.
set(vtk_headers <vtkCellArray.h> <vtkCellData.h> <vtkDoubleArray.h> <vtkFieldData.h> <vtkImageData.h> <vtkInformation.h>
                <vtkMultiBlockDataSet.h> <vtkObjectFactory.h> <vtkPointData.h> <vtkPolyData.h> <vtkStreamingDemandDrivenPipeline.h>)
precompile(Filters PRIVATE ${standard_headers} ${vtk_headers})
precompile(Rendering PRIVATE ${standard_headers} ${vtk_headers} <vtkRenderer.h> <vtkShaderProgram.h> <vtkTextureObject.h>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # Its bug 105651 again, in headers that are precompiled.
    target_compile_options(Filters PRIVATE -Wno-array-bounds)
    target_compile_options(Rendering PRIVATE -Wno-array-bounds)
endif()

# compile_wrapper(TARGET): of code that a toolkit writes to call our classes.
function(compile_wrapper target)
    target_compile_options(${target} PRIVATE ${quick_to_compile})
    if(ANAMORPH_UNITY)
        set_target_properties(${target} PROPERTIES UNITY_BUILD ON)
    endif()
endfunction()

find_package(Python3 REQUIRED COMPONENTS Interpreter Development.Module)
set(python_dir ${CMAKE_INSTALL_LIBDIR}/python3/dist-packages)
vtk_module_wrap_python(MODULES ${anamorph_modules}
                       TARGET Anamorph::AnamorphPython
                       PYTHON_PACKAGE anamorph
                       MODULE_DESTINATION ${python_dir}
                       LIBRARY_DESTINATION ${CMAKE_INSTALL_LIBDIR}
                       CMAKE_DESTINATION ${package_dir}
                       INSTALL_EXPORT AnamorphVTK)
# What VTK's wrapper writes leaves out what Pythons newer than it have in their types.
foreach(wrapper AnamorphFiltersPython AnamorphRenderingPython)
    target_compile_options(${wrapper} PRIVATE -Wno-missing-field-initializers)
    compile_wrapper(${wrapper})
endforeach()
file(GLOB drawing_classes CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/vtk_filters/rendering
     ${PROJECT_SOURCE_DIR}/vtk_filters/rendering/vtkAnamorph*.h)
list(TRANSFORM drawing_classes REPLACE "\\.h$" "")
configure_file(${PROJECT_SOURCE_DIR}/vtk_filters/python/__init__.py
               ${PROJECT_BINARY_DIR}/${python_dir}/anamorph/__init__.py @ONLY)
# In packages the module of the operations is in its place.
install(FILES ${PROJECT_BINARY_DIR}/${python_dir}/anamorph/__init__.py DESTINATION ${python_dir}/anamorph COMPONENT python_alone)
