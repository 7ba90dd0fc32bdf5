#include "pbrt/spectra/spectral_data.h"

#include <charconv>
#include <string_view>

#include "pbrt/core/error.h"

extern "C" {
extern const char pbrt_csv_cie1931[], pbrt_csv_cie1931_end[];
extern const char pbrt_csv_daylight[], pbrt_csv_daylight_end[];
extern const char pbrt_csv_named[], pbrt_csv_named_end[];
extern const char pbrt_csv_sensors[], pbrt_csv_sensors_end[];
extern const char pbrt_csv_colorchecker[], pbrt_csv_colorchecker_end[];
extern const char pbrt_csv_scattering[], pbrt_csv_scattering_end[];
}

namespace pbrt {

namespace {

std::string_view CutField(std::string_view &text, char separator) {
    size_t end = std::min(text.find(separator), text.size());
    std::string_view field = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!field.empty() && field.back() == '\r') field.remove_suffix(1);
    return field;
}

Float ParseNumber(std::string_view field) {
    Float value = 0;
    auto [end, code] = std::from_chars(field.data(), field.data() + field.size(), value);
    PBRT_CHECK_MSG(code == std::errc() && end == field.data() + field.size(), "not a number: \"{}\"", field);
    return value;
}

template <class F>
void ForEachRow(std::string_view text, F row) {
    CutField(text, '\n');
    while (!text.empty()) {
        std::string_view line = CutField(text, '\n');
        if (!line.empty()) row(line);
    }
}

ThreeColumnTable ParseThreeColumns(std::string_view text) {
    ThreeColumnTable table;
    ForEachRow(text, [&](std::string_view line) {
        table.lambdas.push_back(ParseNumber(CutField(line, ',')));
        for (std::vector<Float> &column : table.columns) column.push_back(ParseNumber(CutField(line, ',')));
    });
    return table;
}

/// The first `nameFields` columns, joined by "_", form the name.
std::vector<TabulatedSpectrum> ParseNamedSpectra(std::string_view text, int nameFields = 1) {
    std::vector<TabulatedSpectrum> spectra;
    ForEachRow(text, [&](std::string_view line) {
        std::string name(CutField(line, ','));
        for (int i = 1; i < nameFields; ++i) name.append("_").append(CutField(line, ','));
        if (spectra.empty() || spectra.back().name != name) spectra.push_back({name, {}, {}});
        spectra.back().lambdas.push_back(ParseNumber(CutField(line, ',')));
        spectra.back().values.push_back(ParseNumber(CutField(line, ',')));
    });
    return spectra;
}

}  // namespace

const std::vector<TabulatedSpectrum> &EmbeddedNamedSpectra() {
    static const std::vector<TabulatedSpectrum> spectra = ParseNamedSpectra({pbrt_csv_named, pbrt_csv_named_end});
    return spectra;
}

const std::vector<TabulatedSpectrum> &EmbeddedSensorResponses() {
    static const std::vector<TabulatedSpectrum> spectra =
        ParseNamedSpectra({pbrt_csv_sensors, pbrt_csv_sensors_end}, 2);
    return spectra;
}

const std::vector<TabulatedSpectrum> &EmbeddedColorChecker() {
    static const std::vector<TabulatedSpectrum> spectra =
        ParseNamedSpectra({pbrt_csv_colorchecker, pbrt_csv_colorchecker_end});
    return spectra;
}

const std::vector<ScatteringPreset> &EmbeddedScatteringPresets() {
    static const std::vector<ScatteringPreset> presets = [] {
        std::vector<ScatteringPreset> parsed;
        ForEachRow({pbrt_csv_scattering, pbrt_csv_scattering_end}, [&](std::string_view line) {
            ScatteringPreset &preset = parsed.emplace_back();
            preset.name = CutField(line, ',');
            for (auto *triple : {&preset.reducedScattering, &preset.absorption})
                for (Float &v : *triple) v = ParseNumber(CutField(line, ','));
        });
        return parsed;
    }();
    return presets;
}

const ThreeColumnTable &EmbeddedCie1931() {
    static const ThreeColumnTable table = ParseThreeColumns({pbrt_csv_cie1931, pbrt_csv_cie1931_end});
    return table;
}

const ThreeColumnTable &EmbeddedDaylight() {
    static const ThreeColumnTable table = ParseThreeColumns({pbrt_csv_daylight, pbrt_csv_daylight_end});
    return table;
}

}  // namespace pbrt
