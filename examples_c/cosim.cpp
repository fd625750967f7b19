// The master of cosim_loop.c in C++: the wrapper frees handles, names ports and throws errors. A step that is refused is
// caught, and the simulation goes on as if it had not been asked for.
#include "common.h"
#include <cmath>
#include <stickslip.hpp>
#include <utility>

int main() {
    const stickslip::Model model = stickslip::Model::compile(PAD);
    stickslip::Simulator sim(model);
    sim.init(0.0);
    const stickslip_port stress = model.port("contact.tangential_stress");
    const stickslip_port slip = model.port("contact.slip");
    std::vector<double> values(model.info().outputs);
    stickslip::State start = sim.new_state();
    sim.save(start);
    const double h = 0.02;
    double first = 0.0;
    for (int run = 0; run < 2; run++) {
        sim.restore(start);
        for (int n = 0; n < 50; n++) {
            sim.set_inputs({0.1 * std::fmin((n + 1) * h / 0.5, 1.0), 0.05});
            sim.do_step(n * h, h);
        }
        sim.get_outputs(values);
        const double end = values[slip.offset + slip.length - 1];
        check(run == 0 || end == first, "the run after a rollback is the same bit for bit");
        first = end;
    }
    for (std::size_t i = 0; i < stress.length; i++)
        check(std::fabs(values[stress.offset + i]) <= 0.02 * (1.0 + 1e-9), "the stress is within the static bound");

    bool was_refused = false;
    try {
        sim.do_step(7.0, h);
    } catch (const stickslip::Error &error) {
        was_refused = error.code() == STICKSLIP_STEP;
        std::printf("refused: %s\n", error.what());
    }
    check(was_refused && sim.time() == 1.0, "a step from another time is refused");
    stickslip::Simulator twin = sim.clone();
    twin.do_step(1.0, h);
    sim.do_step(1.0, h);
    check(twin.serialize() == sim.serialize(), "a clone takes the same step");
    const std::vector<double> derivative = sim.directional_derivative({1.0, 0.0});
    check(derivative.size() == values.size(), "one derivative per output");
    stickslip::Simulator moved = std::move(twin);
    check(moved.time() == sim.time(), "a simulator can be moved");
    std::printf("slip at the free end %.6f m\n", first);
    return 0;
}
