// SPDX-License-Identifier: BSD-3-Clause
// Time domain: bench_time [long]
#include <iostream>

#include "time_domain.hpp"

int main(int argc, char**) { straytrace::bench::time_domain(std::cout, argc > 1); }
