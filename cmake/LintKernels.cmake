# Compiles every kernel alone by clang, once for each kind of device, and checks that the kernel for diffuse scenes holds no other
# effect: cmake -DSOURCE_DIR= -DCLANG= -P this.
set(kind_cpu -DCLARAY_CPU=1)
set(kind_gpu -DCLARAY_CPU=0)
set(kind_nvidia -DCLARAY_CPU=0 -DCLARAY_NVIDIA=1 --target=nvptx64-unknown-nvcl -Dasm=__asm__  # C99 reserves no `asm`
    -DRAY_QUEUE=1)
set(kind_effects -DCLARAY_CPU=1 -DCLARAY_INSTANCE_MOTION=1 -DINSTANCES=1 -DINSTANCE_MOTION=1 -DPRIMITIVES=31)  # what is off unless told
set(kind_nvidia_coherent ${kind_nvidia} -DCOHERENT=1 -DPRIMITIVES=31)
set(kind_cutouts ${kind_nvidia_coherent} -DCLARAY_CUTOUTS=1)
set(kind_diffuse -DCLARAY_CPU=1 -DMATERIALS=1 -DNORMALS=0 -DTEXTURES=0 -DMIPMAPS=0 -DENVIRONMENT=0 -DLIGHT_TREE=0  # by sixteen
    -DSPOT_LIGHTS=0 -DDIRECTIONAL_LIGHTS=0 -DLIGHT_FALLOFF=0 -DABSORPTION=0)
set(kind_diffuse_points ${kind_diffuse} -DTRIANGLE_LIGHTS=0)
set(kind_diffuse_lamps ${kind_diffuse} -DPOINT_LIGHTS=0)
set(kind_studied_woop -DCLARAY_CPU=1 -DTRIANGLE_TEST=3 -DBOX_TEST=1 -DNODE_BITS=8 -DCLARAY_COUNT_VISITS=1)
set(kind_studied_double -DCLARAY_CPU=0 -DTRIANGLE_TEST=4 -DBOX_TEST=4 -DNODE_BITS=16 -DCONTRACT=1)
set(kind_textbook -DCLARAY_CPU=1 -DCLARAY_TEXTBOOK_TRIANGLES=1 -DCLARAY_TEXTBOOK_BOXES=1 -DCLARAY_TEXTBOOK_OFFSET=1
    -DCLARAY_TEXTBOOK_GGX=1 -DCLARAY_TEXTBOOK_SUMS=1)
set(kind_textbook_wide ${kind_textbook} -DCLARAY_WIDE=1)
file(GLOB_RECURSE kernels RELATIVE "${SOURCE_DIR}" "${SOURCE_DIR}/kernels/*.cl")
if(NOT kernels)
    message(FATAL_ERROR "no kernels under ${SOURCE_DIR}/kernels")
endif()
set(failed 0)
foreach(kernel IN LISTS kernels)
    foreach(kind cpu gpu effects cutouts nvidia nvidia_coherent diffuse_points diffuse_lamps studied_woop studied_double textbook textbook_wide)
        if(kind MATCHES diffuse AND NOT kernel MATCHES shade_surface)
            continue()
        endif()
        if(kind MATCHES studied AND NOT kernel MATCHES "accuracy/")
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

# What a scene does not call for costs nothing: of the functions for BSDFs, textures, lights and surfaces, the kernel with the macros of
# the Cornell box calls only these. The macros are those of host/effects/effects.cpp, so that a new effect is off here, too.
set(diffuse_functions "bsdf/(bsdf|kinds|lambert|types)|lights/(light|light_triangle|light_types)|shade/surface")
set(passed_through "(eval|sample)_(layers|below_coat)|shading_frame_of")  # return at once, or call the next
file(STRINGS "${SOURCE_DIR}/host/effects/effects.cpp" rows REGEX "EffectRow{.*\"[A-Z_]+\", [A-Z_0-9]+, .*shade")
set(macros -DMATERIALS=1)
foreach(row IN LISTS rows)
    string(REGEX REPLACE ".*\"([A-Z_]+)\".*" "\\1" macro "${row}")
    if(NOT macro MATCHES "^(MATERIALS|TRIANGLE_LIGHTS)$")
        list(APPEND macros -D${macro}=0)
    endif()
endforeach()
file(READ "${SOURCE_DIR}/include/claray/shared/lights.h" lights)
string(REGEX MATCHALL "X\\([a-z_]+, [A-Z_]+, \"" rows "${lights}")
foreach(row IN LISTS rows)
    string(REGEX REPLACE ".*, ([A-Z_]+), .*" "\\1" kind "${row}")
    list(APPEND macros -D${kind}_LIGHTS=0)
endforeach()
foreach(sixteen 0 1)
    execute_process(
        COMMAND "${CLANG}" -x cl -cl-std=CL1.2 -w -O1 -fno-inline -gline-tables-only -S -emit-llvm -Iinclude -Ikernels -DCLARAY_CPU=1
                ${macros} -DSIXTEEN=${sixteen} kernels/render/shade_surface.cl -o -
        WORKING_DIRECTORY "${SOURCE_DIR}" OUTPUT_VARIABLE code RESULT_VARIABLE status)
    string(REGEX MATCHALL "![0-9]+ = !DIFile[^\n]*" files "${code}")
    string(REGEX MATCHALL "= distinct !DISubprogram[^\n]*" functions "${code}")
    if(NOT status EQUAL 0 OR NOT functions)
        message(FATAL_ERROR "shade_surface.cl does not compile for the Cornell box")
    endif()
    foreach(file IN LISTS files)
        string(REGEX REPLACE "^!([0-9]+) .*filename: \"([^\"]*)\".*" "\\1;\\2" file "${file}")
        list(POP_FRONT file number)
        set(file_${number} "${file}")
    endforeach()
    foreach(function IN LISTS functions)
        string(REGEX REPLACE ".*name: \"([^\"]*)\".*file: !([0-9]+).*" "\\1;\\2" function "${function}")
        list(POP_BACK function number)
        if(file_${number} MATCHES "kernels/(bsdf|textures|lights|shade)/" AND NOT file_${number} MATCHES "kernels/(${diffuse_functions})\\.clh"
           AND NOT function MATCHES "^(${passed_through})$")
            message(SEND_ERROR "the kernel for the Cornell box calls ${function} of ${file_${number}}: put it behind its effect's macro")
        endif()
    endforeach()
endforeach()
