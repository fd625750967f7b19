// What converts to a Span, what does not, and that the values arrive.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <stickslip.hpp>
#if __cplusplus >= 202002L
#include <span>
#endif

using stickslip::Span;

namespace {

double sum(Span<const double> values) {
    double total = static_cast<double>(values.size());
    for (std::size_t i = 0; i < values.size(); i++) total += values.data()[i];
    return total;
}

void fill(Span<double> values) {
    for (std::size_t i = 0; i < values.size(); i++) values.data()[i] = 7.0;
}

void must(bool holds, int line) {
    if (holds) return;
    std::fprintf(stderr, "line %d\n", line);
    std::exit(1);
}

struct Base {
    int a;
};
struct Derived : Base {
    int b;
};

static_assert(!std::is_convertible<const double (&)[3], Span<double>>::value, "constant values are not written");
static_assert(!std::is_convertible<const std::vector<double> &, Span<double>>::value, "constant values are not written");
static_assert(!std::is_convertible<std::vector<double>, Span<double>>::value, "nothing is written into what is gone");
static_assert(!std::is_convertible<std::vector<float> &, Span<const double>>::value, "values of another type");
static_assert(!std::is_convertible<float (&)[2], Span<const double>>::value, "values of another type");
static_assert(!std::is_convertible<std::vector<Derived> &, Span<Base>>::value, "values of another size");
static_assert(!std::is_convertible<double, Span<const double>>::value, "no array");

} // namespace

int main() {
    double plain[3] = {1.0, 2.0, 3.0};
    const double constant[2] = {4.0, 5.0};
    std::vector<double> vector = {1.0, 2.0};
    const std::vector<double> fixed = {6.0};
    std::array<double, 2> array = {{8.0, 9.0}};
    must(sum(plain) == 9.0, __LINE__);
    must(sum(constant) == 11.0, __LINE__);
    must(sum(vector) == 5.0, __LINE__);
    must(sum(fixed) == 7.0, __LINE__);
    must(sum(array) == 19.0, __LINE__);
    must(sum({1.0, 2.0, 3.0, 4.0}) == 14.0, __LINE__);
    must(sum({}) == 0.0, __LINE__);
    must(sum(std::vector<double>{2.0}) == 3.0, __LINE__);
    must(sum(Span<const double>(plain, 2)) == 5.0, __LINE__);
    fill(plain);
    fill(vector);
    fill(array);
    must(plain[2] == 7.0 && vector[1] == 7.0 && array[0] == 7.0, __LINE__);
    Span<double> writable(plain);
    must(sum(writable) == 24.0, __LINE__);
#if __cplusplus >= 202002L
    std::span<double> other(plain);
    must(sum(other) == 24.0, __LINE__);
    must(sum(std::span<const double>(plain).first(1)) == 8.0, __LINE__);
#endif

    auto model = stickslip::Model::compile(
        "{\"schema_version\": 1, \"name\": \"x\", \"mesh\": {\"kind\": \"rectangle\", \"size\": [1, 1], \"cells\": [2, 2]},"
        " \"material\": {\"viscosity\": {\"law\": \"isotropic\", \"mu1\": 0.05, \"mu2\": 0.1},"
        " \"elasticity\": {\"law\": \"isotropic\", \"young\": 1, \"poisson\": 0.3, \"convention\": \"plane_strain\"}},"
        " \"clamped\": [\"left\"], \"contact\": {\"part\": \"bottom\", \"friction\": {\"law\": \"exponential\","
        " \"a\": 0.003, \"b\": 0.001, \"alpha\": 1}}, \"loads\": [{\"name\": \"pull\", \"kind\": \"traction\","
        " \"part\": \"right\", \"direction\": [1, 0]}], \"time\": {\"step\": 0.1}}");
    stickslip::Simulator simulator(model);
    const std::uint32_t references[] = {model.port("contact.friction.a").reference,
                                        model.port("contact.friction.b").reference};
    simulator.set(references, {5e-4, 2e-4});
    double a[1];
    simulator.get(references[0], a);
    must(a[0] == 5e-4, __LINE__);
    try {
        simulator.set(references, {1e-4, 2e-4});
        must(false, __LINE__);
    } catch (const stickslip::Error &error) {
        must(error.code() == STICKSLIP_VALUE, __LINE__);
    }
    try {
        simulator.set(references, {1e-4});
        must(false, __LINE__);
    } catch (const stickslip::Error &error) {
        must(error.code() == STICKSLIP_LENGTH, __LINE__);
    }
    double loads[1] = {0.1};
    simulator.init(0.0);
    simulator.set_inputs(loads);
    simulator.do_step(0.0, 0.1);
    return 0;
}
