/* Each text sits between name and name_end. */
    .section .rodata
    .macro embed name, file
    .global \name
    .global \name\()_end
\name:
    .incbin "\file"
\name\()_end:
    .byte 0
    .endm

    embed pbrt_csv_cie1931, cie1931_xyz_1nm.csv
    embed pbrt_csv_daylight, cie_daylight_components.csv
    embed pbrt_csv_named, named_spectra.csv
    embed pbrt_csv_sensors, camera_sensors.csv
    embed pbrt_csv_colorchecker, colorchecker_reflectances.csv
    embed pbrt_csv_scattering, scattering_presets.csv

    .section .note.GNU-stack,"",%progbits
