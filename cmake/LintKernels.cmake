# Compiles every kernel alone by clang, once for each kind of device: cmake -DSOURCE_DIR= -DCLANG= -P this.
set(kind_cpu -DCLARAY_CPU=1)
set(kind_gpu -DCLARAY_CPU=0)
set(kind_nvidia -DCLARAY_CPU=0 -DCLARAY_NVIDIA=1 --target=nvptx64-unknown-nvcl -Dasm=__asm__  # C99 reserves no `asm`
    -DRAY_QUEUE=1)
set(kind_effects -DCLARAY_CPU=1 -DCLARAY_INSTANCE_MOTION=1 -DINSTANCES=1 -DINSTANCE_MOTION=1)  # what is off unless told
set(kind_nvidia_coherent ${kind_nvidia} -DCOHERENT=1)
set(kind_cutouts ${kind_nvidia_coherent} -DCLARAY_CUTOUTS=1)
set(kind_diffuse -DCLARAY_CPU=1 -DMATERIALS=1 -DNORMALS=0 -DTEXTURES=0 -DMIPMAPS=0 -DENVIRONMENT=0 -DLIGHT_TREE=0  # by sixteen
    -DSPOT_LIGHTS=0 -DDIRECTIONAL_LIGHTS=0 -DLIGHT_FALLOFF=0 -DABSORPTION=0)
set(kind_diffuse_points ${kind_diffuse} -DTRIANGLE_LIGHTS=0)
set(kind_diffuse_lamps ${kind_diffuse} -DPOINT_LIGHTS=0)
set(kind_textbook -DCLARAY_CPU=1 -DCLARAY_TEXTBOOK_TRIANGLES=1 -DCLARAY_TEXTBOOK_BOXES=1 -DCLARAY_TEXTBOOK_OFFSET=1
    -DCLARAY_TEXTBOOK_GGX=1 -DCLARAY_TEXTBOOK_SUMS=1)
set(kind_textbook_wide ${kind_textbook} -DCLARAY_WIDE=1)
file(GLOB_RECURSE kernels RELATIVE "${SOURCE_DIR}" "${SOURCE_DIR}/kernels/*.cl")
if(NOT kernels)
    message(FATAL_ERROR "no kernels under ${SOURCE_DIR}/kernels")
endif()
set(failed 0)
foreach(kernel IN LISTS kernels)
    foreach(kind cpu gpu effects cutouts nvidia nvidia_coherent diffuse_points diffuse_lamps textbook textbook_wide)
        if(kind MATCHES diffuse AND NOT kernel MATCHES shade_surface)
            continue()
        endif()
        execute_process(
            COMMAND "${CLANG}" -x cl -cl-std=CL1.2 -fsyntax-only -Wall -Wextra -Werror -Wno-unused-function -Wno-unused-parameter
                    -Iinclude -Ikernels ${kind_${kind}} "${kernel}"
            WORKING_DIRECTORY "${SOURCE_DIR}" RESULT_VARIABLE status ERROR_VARIABLE log)
        if(NOT status EQUAL 0)
            message("${kernel} for ${kind}:\n${log}")
            math(EXPR failed "${failed} + 1")
        endif()
    endforeach()
endforeach()
list(LENGTH kernels count)
if(failed)
    message(FATAL_ERROR "${failed} compilations of ${count} kernels failed")
endif()
message(STATUS "all ${count} kernels compile alone, for CPUs, GPUs and NVIDIA's")
