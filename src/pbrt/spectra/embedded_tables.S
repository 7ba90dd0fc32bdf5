/* Sigmoid coefficients per colour space, layout in rgb_primaries.h. */
    .section .rodata
    .macro embed name, file
    .global \name
    .balign 64
\name:
    .incbin "\file"
    .endm

    embed pbrt_rgb_table_srgb, srgb.bin
    embed pbrt_rgb_table_dci_p3, dci-p3.bin
    embed pbrt_rgb_table_rec2020, rec2020.bin
    embed pbrt_rgb_table_aces2065_1, aces2065-1.bin

    .section .note.GNU-stack,"",%progbits
