#include <charconv>
#include <map>
#include <string_view>

#include "pbrt/core/error.h"
#include "pbrt/spectra/spectrum.h"

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

void ForEachRow(std::string_view text, auto row) {
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

struct TabulatedSpectrum {
    std::string name;
    std::vector<Float> lambdas, values;  ///< nm increasing
};

/// The first `nameFields` columns, joined by "_", form the name.
std::vector<TabulatedSpectrum> ParseSpectra(std::string_view text, int nameFields = 1) {
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

/// Camera sensors, three rows each, named SENSOR_r, SENSOR_g, SENSOR_b.
const std::vector<TabulatedSpectrum> &SensorResponses() {
    static const std::vector<TabulatedSpectrum> spectra = ParseSpectra({pbrt_csv_sensors, pbrt_csv_sensors_end}, 2);
    return spectra;
}

/// Tables that end inside 360-830 nm are extended with their end values, as in stock pbrt-v4.
SpectrumPtr Build(const TabulatedSpectrum &table) {
    std::vector<Float> lambdas = table.lambdas, values = table.values;
    if (lambdas.front() > LambdaMin) {
        lambdas.insert(lambdas.begin(), LambdaMin - 1);
        values.insert(values.begin(), values.front());
    }
    if (lambdas.back() < LambdaMax) {
        lambdas.push_back(LambdaMax + 1);
        values.push_back(values.back());
    }
    if (table.name.starts_with("stdillum-") || table.name.starts_with("illum-")) {
        Float y = InnerProduct(CieY(), PiecewiseLinearSpectrum(lambdas, values));
        for (Float &v : values) v *= CieYIntegral / y;
    }
    return std::make_shared<PiecewiseLinearSpectrum>(std::move(lambdas), std::move(values));
}

const std::map<std::string, SpectrumPtr> &Library() {
    static const std::map<std::string, SpectrumPtr> library = [] {
        std::map<std::string, SpectrumPtr> spectra;
        for (const TabulatedSpectrum &table : ParseSpectra({pbrt_csv_named, pbrt_csv_named_end}))
            spectra[table.name] = Build(table);
        for (const TabulatedSpectrum &table : SensorResponses()) spectra[table.name] = Build(table);
        return spectra;
    }();
    return library;
}

const std::array<DenseSpectrum, 3> &MatchingFunctions() {
    static const std::array<DenseSpectrum, 3> functions = [] {
        const ThreeColumnTable table = ParseThreeColumns({pbrt_csv_cie1931, pbrt_csv_cie1931_end});
        PBRT_CHECK(table.lambdas.front() == LambdaMin && table.lambdas.back() == LambdaMax);
        auto column = [&](size_t i) { return DenseSpectrum(table.columns[i]); };
        return std::array{column(0), column(1), column(2)};
    }();
    return functions;
}

}  // namespace

const DenseSpectrum &CieX() { return MatchingFunctions()[0]; }
const DenseSpectrum &CieY() { return MatchingFunctions()[1]; }
const DenseSpectrum &CieZ() { return MatchingFunctions()[2]; }

SpectrumPtr NamedSpectrum(const std::string &name) {
    auto found = Library().find(name);
    return found != Library().end() ? found->second : nullptr;
}

std::vector<std::string> NamedSpectrumNames() {
    std::vector<std::string> names;
    for (const auto &[name, spectrum] : Library()) names.push_back(name);
    return names;
}

std::vector<std::string> CameraSensorNames() {
    std::vector<std::string> names;
    for (const TabulatedSpectrum &table : SensorResponses())
        if (table.name.ends_with("_r")) names.push_back(table.name.substr(0, table.name.size() - 2));
    return names;
}

const std::vector<SpectrumPtr> &ColorCheckerReflectances() {
    static const std::vector<SpectrumPtr> patches = [] {
        std::vector<SpectrumPtr> spectra;
        for (const TabulatedSpectrum &table : ParseSpectra({pbrt_csv_colorchecker, pbrt_csv_colorchecker_end}))
            spectra.push_back(Build(table));
        return spectra;
    }();
    return patches;
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

const ThreeColumnTable &EmbeddedDaylight() {
    static const ThreeColumnTable table = ParseThreeColumns({pbrt_csv_daylight, pbrt_csv_daylight_end});
    return table;
}

}  // namespace pbrt
