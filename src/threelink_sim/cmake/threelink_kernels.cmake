# Kernel files are compiled once for each instruction set; the code that calls them chooses at run time.
#
#   threelink_add_kernels(TARGET STEM)
#
# adds STEM_baseline.cpp and, on x86-64, STEM_avx2.cpp and STEM_avx512.cpp. -ffp-contract=off: only
# the fused multiply-adds that are written are made, so that all instruction sets give the same bits.
function(threelink_add_kernels target stem)
  set(common "-O3;-ffp-contract=off;-fno-math-errno;-fno-trapping-math")
  set(isas baseline)
  set(flags_baseline "")
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    list(APPEND isas avx2 avx512)
    set(flags_avx2 "-mavx2;-mfma")
    set(flags_avx512 "-mavx2;-mfma;-mavx512f;-mavx512dq;-mavx512bw;-mavx512vl;-mprefer-vector-width=512;-mtune=icelake-server;-fno-gcse")
    target_compile_definitions(${target} PRIVATE THREELINK_X86)
  endif()
  foreach(isa ${isas})
    target_sources(${target} PRIVATE ${stem}_${isa}.cpp)
    set_source_files_properties(${stem}_${isa}.cpp PROPERTIES
      COMPILE_OPTIONS "${common};${flags_${isa}}")
  endforeach()
endfunction()
