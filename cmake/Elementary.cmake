# exp, log, pow, sin and their kin by one code on every processor. glibc chooses another one where there are fused multiply-adds;
# its last bits differ, and a search of capacitors, parts or names may come to another end for them. musl's (the same authors' exp,
# log and pow; all within 1 ulp) have one. Debian has them as object files in musl-dev; those named here use nothing else of musl.
# Without them the system's are taken, and --version says so.
set(BODESMITH_MUSL "")
string(REGEX REPLACE "-gnu$" "-musl" musl_architecture "${CMAKE_LIBRARY_ARCHITECTURE}")
find_file(MUSL_ARCHIVE libc.a PATHS /usr/lib/${musl_architecture} NO_DEFAULT_PATH)
if(MUSL_ARCHIVE)
  set(functions exp exp2 expm1 log log2 log10 log1p pow sin cos tan sincos asin acos atan atan2 sinh cosh tanh asinh acosh atanh
    cexp clog cpow csqrt csin ccos ctan csinh ccosh ctanh casin cacos catan casinh cacosh catanh cabs carg hypot cbrt erf lgamma_r tgamma
    exp_data log_data log2_data pow_data __math_oflow __math_uflow __math_xflow __math_divzero __math_invalid
    __cos __sin __tan __rem_pio2 __rem_pio2_large __expo2 __cexp)
  list(TRANSFORM functions APPEND .lo OUTPUT_VARIABLE members)
  bodesmith_from_archive(elementary ${MUSL_ARCHIVE} ${members})
  if(TARGET bodesmith_elementary)
    execute_process(COMMAND dpkg-query -W -f "\${Version}" musl-dev OUTPUT_VARIABLE BODESMITH_MUSL ERROR_QUIET)
    string(REGEX REPLACE "-.*" "" BODESMITH_MUSL "${BODESMITH_MUSL}")
  else()
    message(WARNING "${elementary_ERROR}: the system's are used, whose last bits depend on the processor")
  endif()
else()
  message(STATUS "musl-dev is not installed: exp, log, sin are the system's, whose last bits depend on the processor")
endif()
