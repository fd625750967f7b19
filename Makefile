# Installs the C library: make && make install PREFIX=/usr/local [DESTDIR=...]
# Needs a Rust toolchain and binutils (ld, objcopy), which a C compiler comes with. Shared and static library, headers,
# pkg-config file, CMake package, licence and third-party notices.

PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
DOCDIR ?= $(PREFIX)/share/doc/stickslip
CARGO ?= cargo
LD ?= ld
OBJCOPY ?= objcopy
BUILT := $(or $(CARGO_TARGET_DIR),target)/release
STATIC := $(BUILT)/c/libstickslip.a

VERSION := $(shell sed -n 's/^version = "\(.*\)"$$/\1/p' Cargo.toml | head -n 1)
ABI := $(shell sed -n 's/.*STICKSLIP_ABI_VERSION: u32 = \([0-9]*\);/\1/p' src/capi/mod.rs)
SONAME := libstickslip.so.$(ABI)
REAL := libstickslip.so.$(VERSION)
FILL = sed -e 's|@PREFIX@|$(PREFIX)|g' -e 's|@LIBDIR@|$(LIBDIR)|g' -e 's|@INCLUDEDIR@|$(INCLUDEDIR)|g' \
	-e 's|@VERSION@|$(VERSION)|g' -e 's|@SONAME@|$(SONAME)|g'

all:
	$(CARGO) rustc --release --lib --package stickslip --features capi --crate-type cdylib,staticlib -- \
		-C link-arg=-Wl,-soname,$(SONAME)
	$(MAKE) --no-print-directory $(STATIC)

# One object in which everything but the interface is local: Rust's own symbols and those of its standard library would meet
# those of another static library. What the functions of the header do not reach is left out.
$(STATIC): $(BUILT)/libstickslip.a include/stickslip.h
	install -d $(dir $@)
	$(LD) -r --gc-sections $$(sed -n 's/.*[ *]\(stickslip_[a-z_]*\)(.*/-u \1/p' include/stickslip.h) -o $(dir $@)stickslip.o $<
	$(OBJCOPY) --strip-debug --remove-section=.llvmbc --remove-section=.llvmcmd \
		--wildcard --keep-global-symbol='stickslip_*' $(dir $@)stickslip.o
	rm -f $@
	$(AR) rcs $@ $(dir $@)stickslip.o

install: all
	install -d $(DESTDIR)$(LIBDIR)/pkgconfig $(DESTDIR)$(LIBDIR)/cmake/stickslip $(DESTDIR)$(INCLUDEDIR) $(DESTDIR)$(DOCDIR)
	install -m 755 $(BUILT)/libstickslip.so $(DESTDIR)$(LIBDIR)/$(REAL)
	ln -sf $(REAL) $(DESTDIR)$(LIBDIR)/$(SONAME)
	ln -sf $(SONAME) $(DESTDIR)$(LIBDIR)/libstickslip.so
	install -m 644 $(STATIC) $(DESTDIR)$(LIBDIR)/
	install -m 644 LICENSE THIRD-PARTY-NOTICES.txt $(DESTDIR)$(DOCDIR)/
	install -m 644 include/stickslip.h include/stickslip.hpp $(DESTDIR)$(INCLUDEDIR)/
	$(FILL) packaging/stickslip.pc.in > $(DESTDIR)$(LIBDIR)/pkgconfig/stickslip.pc
	$(FILL) packaging/stickslipConfig.cmake.in > $(DESTDIR)$(LIBDIR)/cmake/stickslip/stickslipConfig.cmake
	$(FILL) packaging/stickslipConfigVersion.cmake.in > $(DESTDIR)$(LIBDIR)/cmake/stickslip/stickslipConfigVersion.cmake

uninstall:
	rm -f $(DESTDIR)$(LIBDIR)/libstickslip.so $(DESTDIR)$(LIBDIR)/$(SONAME) $(DESTDIR)$(LIBDIR)/$(REAL) \
		$(DESTDIR)$(LIBDIR)/libstickslip.a $(DESTDIR)$(LIBDIR)/pkgconfig/stickslip.pc \
		$(DESTDIR)$(INCLUDEDIR)/stickslip.h $(DESTDIR)$(INCLUDEDIR)/stickslip.hpp
	rm -rf $(DESTDIR)$(LIBDIR)/cmake/stickslip $(DESTDIR)$(DOCDIR)

.PHONY: all install uninstall
