#include "pbrt/spectra/tools/sigmoid_fit.h"

#include <cmath>

#include "pbrt/spectra/spectrum.h"

namespace pbrt {

namespace {

constexpr double kMaxCoefficient = 200;
constexpr int kMaxEvaluations = 24;
constexpr double kGoodEnough = 1e-10;  // squared CIELAB distance
constexpr size_t kVectorLength = 8;

bool Solve3(const double a[3][3], const double b[3], double x[3]) {
    double c00 = a[1][1] * a[2][2] - a[1][2] * a[2][1], c01 = a[1][2] * a[2][0] - a[1][0] * a[2][2];
    double c02 = a[1][0] * a[2][1] - a[1][1] * a[2][0];
    double determinant = a[0][0] * c00 + a[0][1] * c01 + a[0][2] * c02;
    if (!(std::abs(determinant) > 1e-300)) return false;
    double inverse = 1 / determinant;
    x[0] = inverse * (b[0] * c00 + b[1] * (a[0][2] * a[2][1] - a[0][1] * a[2][2]) +
                      b[2] * (a[0][1] * a[1][2] - a[0][2] * a[1][1]));
    x[1] = inverse * (b[0] * c01 + b[1] * (a[0][0] * a[2][2] - a[0][2] * a[2][0]) +
                      b[2] * (a[0][2] * a[1][0] - a[0][0] * a[1][2]));
    x[2] = inverse * (b[0] * c02 + b[1] * (a[0][1] * a[2][0] - a[0][0] * a[2][1]) +
                      b[2] * (a[0][0] * a[1][1] - a[0][1] * a[1][0]));
    return true;
}

double Largest(const double c[3]) { return std::max({std::abs(c[0]), std::abs(c[1]), std::abs(c[2])}); }

}  // namespace

SigmoidFit::SigmoidFit(const RgbPrimaries &space) {
    SpectrumPtr illuminant = NamedSpectrum(space.illuminant);
    const DenseSpectrum *matching[3] = {&CieX(), &CieY(), &CieZ()};
    double sumY = double(InnerProduct(CieY(), *illuminant));
    for (Float lambda = LambdaMin; lambda <= LambdaMax; ++lambda) {
        weights_.position.push_back(double(lambda - LambdaMin) / double(LambdaMax - LambdaMin));
        for (size_t k = 0; k < 3; ++k)
            weights_.weights[k].push_back(double((*matching[k])(lambda)) * double((*illuminant)(lambda)) / sumY);
    }
    while (weights_.position.size() % kVectorLength != 0) {
        weights_.position.push_back(0);
        for (std::vector<double> &w : weights_.weights) w.push_back(0);
    }
    for (size_t k = 0; k < 3; ++k) {
        white_[k] = 0;
        for (double w : weights_.weights[k]) white_[k] += w;
    }
    Vector3 white(static_cast<Float>(white_[0]), static_cast<Float>(white_[1]), static_cast<Float>(white_[2]));
    xyzFromRgb_ = glm::dmat3(ComputeXyzFromRgb(space.r, space.g, space.b, white));
}

void SigmoidFit::Lab(const double xyz[3], double lab[3], double derivative[3]) const {
    constexpr double delta = 6.0 / 29;
    double f[3];
    for (int k = 0; k < 3; ++k) {
        double t = xyz[k] / white_[k];
        if (t > delta * delta * delta) {
            f[k] = std::cbrt(t);
            derivative[k] = 1 / (3 * f[k] * f[k] * white_[k]);
        } else {
            f[k] = t / (3 * delta * delta) + 4.0 / 29;
            derivative[k] = 1 / (3 * delta * delta * white_[k]);
        }
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 500 * (f[0] - f[1]);
    lab[2] = 200 * (f[1] - f[2]);
}

double SigmoidFit::Residual(const double c[3], const double target[3], double r[3], double jacobian[3][3]) const {
    SigmoidIntegrals integrals;
    IntegrateSigmoid(weights_, c, &integrals);
    double lab[3], d[3];
    Lab(integrals.xyz, lab, d);
    for (int k = 0; k < 3; ++k) r[k] = target[k] - lab[k];
    for (int j = 0; j < 3; ++j) {
        double fx = d[0] * integrals.jacobian[0][j], fy = d[1] * integrals.jacobian[1][j];
        double fz = d[2] * integrals.jacobian[2][j];
        jacobian[0][j] = 116 * fy;
        jacobian[1][j] = 500 * (fx - fy);
        jacobian[2][j] = 200 * (fy - fz);
    }
    return r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
}

double SigmoidFit::Fit(const double rgb[3], double c[3]) const {
    glm::dvec3 xyz = xyzFromRgb_ * glm::dvec3(rgb[0], rgb[1], rgb[2]);
    double target[3], unused[3];
    const double xyzArray[3] = {xyz.x, xyz.y, xyz.z};
    Lab(xyzArray, target, unused);

    double r[3], jacobian[3][3];
    double error = Residual(c, target, r, jacobian), damping = 0;
    for (int evaluations = 1; evaluations < kMaxEvaluations && error > kGoodEnough; ++evaluations) {
        double normal[3][3], gradient[3], step[3];
        for (int i = 0; i < 3; ++i) {
            gradient[i] = 0;
            for (int k = 0; k < 3; ++k) gradient[i] += jacobian[k][i] * r[k];
            for (int j = 0; j < 3; ++j) {
                normal[i][j] = 0;
                for (int k = 0; k < 3; ++k) normal[i][j] += jacobian[k][i] * jacobian[k][j];
            }
        }
        // Without damping the square system is solved directly: forming normal equations would lose half the digits.
        bool solved = damping == 0 && Solve3(jacobian, r, step);
        if (!solved) {
            damping = std::max(damping, 1e-6);
            for (int i = 0; i < 3; ++i) normal[i][i] *= 1 + damping;
            if (!Solve3(normal, gradient, step)) break;
        }
        double trial[3] = {c[0] + step[0], c[1] + step[1], c[2] + step[2]};
        if (double largest = Largest(trial); largest > kMaxCoefficient)
            for (double &v : trial) v *= kMaxCoefficient / largest;
        double trialR[3], trialJacobian[3][3];
        double trialError = Residual(trial, target, trialR, trialJacobian);
        if (trialError < error) {
            bool stalled = trialError > error * (1 - 1e-5);
            error = trialError;
            std::copy(trial, trial + 3, c);
            std::copy(trialR, trialR + 3, r);
            std::copy(&trialJacobian[0][0], &trialJacobian[0][0] + 9, &jacobian[0][0]);
            damping = damping < 1e-5 ? 0 : damping * 0.1;
            if (stalled) break;
        } else {
            damping = damping == 0 ? 1e-3 : damping * 10;
            if (damping > 1e5) break;
        }
    }
    return std::sqrt(error);
}

void SigmoidFit::ToNanometres(const double c[3], float out[3]) {
    constexpr double low = double(LambdaMin), s = 1 / (double(LambdaMax) - double(LambdaMin));
    out[0] = static_cast<float>(c[0] * s * s);
    out[1] = static_cast<float>(c[1] * s - 2 * c[0] * low * s * s);
    out[2] = static_cast<float>(c[2] - c[1] * low * s + c[0] * low * low * s * s);
}

}  // namespace pbrt
