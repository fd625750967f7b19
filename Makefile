# Installs the C library: make && make install PREFIX=/usr/local [DESTDIR=...]
# Needs only a Rust toolchain. Shared and static library, headers, pkg-config file, CMake package.

PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
CARGO ?= cargo
BUILT := $(or $(CARGO_TARGET_DIR),target)/release

VERSION := $(shell sed -n 's/^version = "\(.*\)"$$/\1/p' Cargo.toml | head -n 1)
ABI := $(shell sed -n 's/.*STICKSLIP_ABI_VERSION: u32 = \([0-9]*\);/\1/p' src/capi/mod.rs)
SONAME := libstickslip.so.$(ABI)
REAL := libstickslip.so.$(VERSION)
FILL = sed -e 's|@PREFIX@|$(PREFIX)|g' -e 's|@LIBDIR@|$(LIBDIR)|g' -e 's|@INCLUDEDIR@|$(INCLUDEDIR)|g' \
	-e 's|@VERSION@|$(VERSION)|g' -e 's|@SONAME@|$(SONAME)|g'

all:
	$(CARGO) rustc --release --lib --package stickslip --features capi --crate-type cdylib,staticlib -- \
		-C link-arg=-Wl,-soname,$(SONAME)

install: all
	install -d $(DESTDIR)$(LIBDIR)/pkgconfig $(DESTDIR)$(LIBDIR)/cmake/stickslip $(DESTDIR)$(INCLUDEDIR)
	install -m 755 $(BUILT)/libstickslip.so $(DESTDIR)$(LIBDIR)/$(REAL)
	ln -sf $(REAL) $(DESTDIR)$(LIBDIR)/$(SONAME)
	ln -sf $(SONAME) $(DESTDIR)$(LIBDIR)/libstickslip.so
	install -m 644 $(BUILT)/libstickslip.a $(DESTDIR)$(LIBDIR)/
	install -m 644 include/stickslip.h include/stickslip.hpp $(DESTDIR)$(INCLUDEDIR)/
	$(FILL) packaging/stickslip.pc.in > $(DESTDIR)$(LIBDIR)/pkgconfig/stickslip.pc
	$(FILL) packaging/stickslipConfig.cmake.in > $(DESTDIR)$(LIBDIR)/cmake/stickslip/stickslipConfig.cmake
	$(FILL) packaging/stickslipConfigVersion.cmake.in > $(DESTDIR)$(LIBDIR)/cmake/stickslip/stickslipConfigVersion.cmake

uninstall:
	rm -f $(DESTDIR)$(LIBDIR)/libstickslip.so $(DESTDIR)$(LIBDIR)/$(SONAME) $(DESTDIR)$(LIBDIR)/$(REAL) \
		$(DESTDIR)$(LIBDIR)/libstickslip.a $(DESTDIR)$(LIBDIR)/pkgconfig/stickslip.pc \
		$(DESTDIR)$(INCLUDEDIR)/stickslip.h $(DESTDIR)$(INCLUDEDIR)/stickslip.hpp
	rm -rf $(DESTDIR)$(LIBDIR)/cmake/stickslip

.PHONY: all install uninstall
