// C++ part of the shim, for programs with parts in C++: compiled by the C++ compiler and linked beside shim.c.
//
// It exits from a stopped program by forced unwinding, as pthread_exit does, so that destructors of automatic
// objects run; it reports uncaught exceptions; and it feeds std::random_device from the robot's own stream.
#include <cxxabi.h>
#include <unwind.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <typeinfo>

#define HIDDEN __attribute__((visibility("hidden")))
#define NAMED(name) __asm__(#name) __attribute__((weak))

struct exit_point;

// Defined in shim.c.
extern "C" {
HIDDEN [[noreturn]] void eyesim_jump(struct exit_point *exit_point);
HIDDEN [[noreturn]] void eyesim_uncaught(const char *text, const void *const *stack, std::size_t depth);
HIDDEN bool eyesim_is_unwinding();
HIDDEN std::uint32_t eyesim_entropy();
HIDDEN std::size_t eyesim_stack(const void **addresses, std::size_t room);
HIDDEN void *eyesim_allocated(std::size_t len, const void *caller);
}

namespace {

// Exception that unwinds the program; its type is private, so that no handler names it.
struct StopException {
    _Unwind_Exception exception; // first member: the unwinder passes it back
    struct exit_point *exit_point;
};

// Called for each unwound frame, the innermost first.
_Unwind_Reason_Code step(int, _Unwind_Action actions, _Unwind_Exception_Class, _Unwind_Exception *,
                         _Unwind_Context *context, void *exit_point)
{
    // The stack grows down: everything above the frame belongs to the host.
    const bool is_out = (actions & _UA_END_OF_STACK) != 0 ||
                        _Unwind_GetCFA(context) >= reinterpret_cast<std::uintptr_t>(exit_point);
    if (is_out)
        eyesim_jump(static_cast<struct exit_point *>(exit_point));
    return _URC_NO_REASON;
}

// Called if a `catch (...)` does not rethrow: the rest of the stack is dropped without destructors.
void not_rethrown(_Unwind_Reason_Code, _Unwind_Exception *exception)
{
    eyesim_jump(reinterpret_cast<StopException *>(exception)->exit_point);
}

// Demangled name of a type. May allocate, since the program has ended.
const char *name_of(const std::type_info &type)
{
    int status = 0;
    const char *name = abi::__cxa_demangle(type.name(), nullptr, nullptr, &status);
    return status == 0 && name != nullptr ? name : type.name();
}

// Return addresses of the calls in progress, the innermost first.
struct CallStack {
    const void **addresses;
    std::size_t depth, room;
};

_Unwind_Reason_Code add_to(_Unwind_Context *context, void *stack)
{
    CallStack &to = *static_cast<CallStack *>(stack);
    if (to.depth == to.room)
        return _URC_END_OF_STACK;
    to.addresses[to.depth++] = reinterpret_cast<const void *>(_Unwind_GetIP(context));
    return _URC_NO_REASON;
}

// No handler was found, so nothing is unwound yet: the stack is that of the `throw`.
[[noreturn]] void uncaught()
{
    char text[512];
    const void *stack[64];
    // Unwinding has met a function that throws nothing: a destructor, or one that is `noexcept`.
    if (eyesim_is_unwinding())
        eyesim_uncaught(nullptr, nullptr, 0);
    const std::size_t depth = eyesim_stack(stack, sizeof stack / sizeof *stack);
    const std::type_info *type = abi::__cxa_current_exception_type();
    if (type == nullptr)
        eyesim_uncaught("std::terminate was called", stack, depth);
    try {
        throw;
    } catch (const std::exception &exception) {
        std::snprintf(text, sizeof text, "uncaught exception `%s`: %s", name_of(*type), exception.what());
    } catch (const char *said) {
        std::snprintf(text, sizeof text, "uncaught exception `%s`: %s", name_of(*type), said);
    } catch (...) {
        std::snprintf(text, sizeof text, "uncaught exception `%s`", name_of(*type));
    }
    eyesim_uncaught(text, stack, depth);
}

} // namespace

// Stores the return addresses of the calls in progress, the innermost first; returns their number.
extern "C" HIDDEN std::size_t eyesim_stack(const void **addresses, std::size_t room)
{
    CallStack stack = {addresses, 0, room};
    _Unwind_Backtrace(add_to, &stack);
    return stack.depth;
}

extern "C" HIDDEN void eyesim_report_uncaught()
{
    std::set_terminate(uncaught);
}

// Runs the destructors between here and `exit_point`, and jumps there. Returns if the stack cannot be walked.
extern "C" HIDDEN void eyesim_unwind(struct exit_point *exit_point)
{
    StopException *leaving = static_cast<StopException *>(std::calloc(1, sizeof(StopException)));
    if (leaving == nullptr)
        return;
    leaving->exit_point = exit_point;
    leaving->exception.exception_cleanup = not_rethrown;
    _Unwind_ForcedUnwind(&leaving->exception, step, exit_point);
}

namespace {

void *allocated(std::size_t len, const void *caller)
{
    for (;;) {
        if (void *memory = eyesim_allocated(len == 0 ? 1 : len, caller))
            return memory;
        if (const std::new_handler handler = std::get_new_handler())
            handler();
        else
            throw std::bad_alloc();
    }
}

} // namespace

// Like the operators of the C++ library, but with the program's call site. The program's own operators take precedence.
__attribute__((weak, noinline)) void *operator new(std::size_t len) { return allocated(len, __builtin_return_address(0)); }
__attribute__((weak, noinline)) void *operator new[](std::size_t len) { return allocated(len, __builtin_return_address(0)); }

// Called by the C++ library when it finds a wrong index or an empty container (_GLIBCXX_ASSERTIONS).
extern "C" [[noreturn]] void library_refuses(const char *, int, const char *, const char *condition)
    NAMED(_ZSt21__glibcxx_assert_failPKciS0_S0_);
void library_refuses(const char *, int, const char *, const char *condition)
{
    char text[512];
    const void *stack[64];
    std::snprintf(text, sizeof text, "assertion of the C++ library failed: %s", condition);
    eyesim_uncaught(text, stack, eyesim_stack(stack, sizeof stack / sizeof *stack));
}

// A function without a body is called. The library's own function would stop with the same words, but is missing in a
// static link, whose calls would then jump to address 0.
extern "C" {
[[noreturn]] void pure_virtual() NAMED(__cxa_pure_virtual);
void pure_virtual()
{
    const void *stack[64];
    eyesim_uncaught("a pure virtual function (`= 0`) is called: a constructor or destructor of its class calls it",
                    stack, eyesim_stack(stack, sizeof stack / sizeof *stack));
}
}

// std::random_device of libstdc++ would use the processor's generator.
extern "C" {
void device_init(void *, const void *) NAMED(_ZNSt13random_device7_M_initERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE);
void device_init_old(void *, const void *) NAMED(_ZNSt13random_device7_M_initERKSs);
void device_init_text(void *, const char *, std::size_t) NAMED(_ZNSt13random_device7_M_initEPKcm);
void device_init_tr1(void *, const void *) NAMED(_ZNSt13random_device14_M_init_pretr1ERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE);
void device_init_tr1_old(void *, const void *) NAMED(_ZNSt13random_device14_M_init_pretr1ERKSs);
void device_fini(void *) NAMED(_ZNSt13random_device7_M_finiEv);
std::uint32_t device_value(void *) NAMED(_ZNSt13random_device9_M_getvalEv);
std::uint32_t device_value_tr1(void *) NAMED(_ZNSt13random_device16_M_getval_pretr1Ev);
double device_entropy(const void *) NAMED(_ZNKSt13random_device13_M_getentropyEv);

void device_init(void *, const void *) {}
void device_init_old(void *, const void *) {}
void device_init_text(void *, const char *, std::size_t) {}
void device_init_tr1(void *, const void *) {}
void device_init_tr1_old(void *, const void *) {}
void device_fini(void *) {}
std::uint32_t device_value(void *) { return eyesim_entropy(); }
std::uint32_t device_value_tr1(void *) { return eyesim_entropy(); }
double device_entropy(const void *) { return 32; }
}
