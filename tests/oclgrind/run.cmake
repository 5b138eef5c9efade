# Runs a test program in Oclgrind, whose simulated device reports every access out of bounds. Any report fails:
#   cmake -DOCLGRIND= -DPROGRAM= -P this
set(ENV{CLARAY_CACHE_DIR} "/dev/null/none")  # its programs are no one else's
set(ENV{CLARAY_DEVICE} 0)
# Unoptimised, since Oclgrind 21.10 lacks intrinsics that optimisation introduces (llvm.experimental.noalias.scope.decl).
# Reports go to standard error; a log file would be started anew with every device that is opened.
execute_process(COMMAND "${OCLGRIND}" --max-errors 20 --build-options -cl-opt-disable "${PROGRAM}"
                RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE report)
if(NOT status EQUAL 0)
    message(FATAL_ERROR "the tests failed in Oclgrind (${status}):\n${output}\n${report}")
endif()
if(NOT output MATCHES "Oclgrind Simulator")
    message(FATAL_ERROR "the tests did not run on Oclgrind's device:\n${output}")
endif()
if(NOT report STREQUAL "")
    message(FATAL_ERROR "Oclgrind reports:\n${report}")
endif()
message("${output}")
