/* fmi2CallbackLogger: formats the message and hands it to a function without variable arguments. */
#include <stdarg.h>
#include <stdio.h>

extern void plimsoll_test_receive(void *environment, int status, const char *category, const char *message);

void plimsoll_test_logger(void *environment, const char *name, int status, const char *category, const char *format, ...)
{
    char message[4096];
    va_list arguments;
    (void)name;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    plimsoll_test_receive(environment, status, category, message);
}
