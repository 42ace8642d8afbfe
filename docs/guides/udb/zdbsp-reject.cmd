@echo off
rem Builds nodes with zdbsp, then REJECT lumps with sightlines in the file that zdbsp has written.
rem
rem   zdbsp-reject.cmd [options of zdbsp] -oOUT.wad IN.wad
rem
rem Both programs are looked for beside this script, then in PATH; ZDBSP and SIGHTLINES name others.
rem Says nothing but what goes wrong: an editor may take any word for a failure.
setlocal
if not defined ZDBSP if exist "%~dp0zdbsp.exe" (set "ZDBSP=%~dp0zdbsp.exe") else (set "ZDBSP=zdbsp")
if not defined SIGHTLINES if exist "%~dp0sightlines.exe" (set "SIGHTLINES=%~dp0sightlines.exe") else (set "SIGHTLINES=sightlines")

rem The file that zdbsp writes: -oOUT or -o OUT; without any of them tmp.wad.
set "ALL=%*"
set "OUT=tmp.wad"
:next
if "%~1"=="" goto build
set "WORD=%~1"
if "%WORD%"=="-o" (
    set "OUT=%~2"
    shift
) else if "%WORD%"=="--output" (
    set "OUT=%~2"
    shift
) else if "%WORD:~0,2%"=="-o" (
    set "OUT=%WORD:~2%"
)
shift
goto next

:build
"%ZDBSP%" %ALL% >"%OUT%.log" 2>&1
if not "%errorlevel%"=="0" (
    type "%OUT%.log" 1>&2
    echo error: zdbsp failed 1>&2
    del "%OUT%.log"
    exit /b 1
)
del "%OUT%.log"
"%SIGHTLINES%" -q reject "%OUT%" -o "%OUT%" --strict >nul
if not "%errorlevel%"=="0" (
    echo error: no REJECT lump was built in "%OUT%" 1>&2
    exit /b 2
)
exit /b 0
