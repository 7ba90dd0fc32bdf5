#include <map>

#include "pbrt/spectra/spectral_data.h"
#include "pbrt/spectra/spectrum.h"

namespace pbrt {

namespace {

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
    bool isIlluminant = table.name.starts_with("stdillum-") || table.name.starts_with("illum-");
    if (isIlluminant) {
        Float y = InnerProduct(CieY(), PiecewiseLinearSpectrum(lambdas, values));
        for (Float &v : values) v *= CieYIntegral / y;
    }
    return std::make_shared<PiecewiseLinearSpectrum>(std::move(lambdas), std::move(values));
}

const std::map<std::string, SpectrumPtr> &Library() {
    static const std::map<std::string, SpectrumPtr> library = [] {
        std::map<std::string, SpectrumPtr> spectra;
        for (const TabulatedSpectrum &table : EmbeddedNamedSpectra()) spectra[table.name] = Build(table);
        for (const TabulatedSpectrum &table : EmbeddedSensorResponses()) spectra[table.name] = Build(table);
        return spectra;
    }();
    return library;
}

}  // namespace

SpectrumPtr NamedSpectrum(const std::string &name) {
    auto found = Library().find(name);
    return found != Library().end() ? found->second : nullptr;
}

const std::vector<SpectrumPtr> &ColorCheckerReflectances() {
    static const std::vector<SpectrumPtr> patches = [] {
        std::vector<SpectrumPtr> spectra;
        for (const TabulatedSpectrum &table : EmbeddedColorChecker()) spectra.push_back(Build(table));
        return spectra;
    }();
    return patches;
}

std::vector<std::string> CameraSensorNames() {
    std::vector<std::string> names;
    for (const TabulatedSpectrum &table : EmbeddedSensorResponses())
        if (table.name.ends_with("_r")) names.push_back(table.name.substr(0, table.name.size() - 2));
    return names;
}

std::vector<std::string> NamedSpectrumNames() {
    std::vector<std::string> names;
    for (const auto &[name, spectrum] : Library()) names.push_back(name);
    return names;
}

}  // namespace pbrt
