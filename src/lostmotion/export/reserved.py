"""Words that no exported name may be, in any dialect; compared without case.

A block is exported to all tools under the same names, so a word that one of them keeps for itself is out for all: as a
keyword, or as a function or function block that comes with the tool and is known before the user's text is read.
"""

from __future__ import annotations

import re

from lostmotion.files.tag_file import DEVICES

TYPES = (
    "bool byte word dword lword sint int dint lint usint uint udint ulint real lreal time ltime date ldate tod ltod dt "
    "ldt time_of_day ltime_of_day date_and_time ldate_and_time string wstring char wchar"
)

GROUPS: dict[str, str] = {
    # IEC 61131-3 ed. 2, annex C (delimiters and keywords), and what ed. 3 adds in table 1 ff.: classes, references.
    "keyword of IEC 61131-3": """
        abstract action and any any_bit any_chars any_char any_date any_derived any_duration any_elementary any_int
        any_magnitude any_num any_real any_signed any_string any_unsigned array at begin by case class configuration
        constant continue do else elsif en end_action end_case end_class end_configuration end_for end_function
        end_function_block end_if end_interface end_method end_namespace end_program end_repeat end_resource end_step
        end_struct end_transition end_type end_var end_while eno exit extends f_edge false final for from function
        function_block if implements initial_step interface internal method mod namespace non_retain not null of on or
        overlap override private program protected public r_edge read_only read_write ref ref_to repeat resource
        retain return step struct super task then this to transition true type until using var var_access var_config
        var_external var_global var_in_out var_input var_output var_temp while with xor
    """,
    # IEC 61131-3 ed. 2, table 10 (elementary data types); ed. 3 adds the long ones.
    "type of IEC 61131-3": TYPES,
    # IEC 61131-3 ed. 2, annex C, operators of the instruction list; TwinCAT and CODESYS keep them in ST as well.
    "operator of IEC 61131-3": """
        andn cal calc calcn clk cd cu in jmp jmpc jmpcn ld ldn orn pt pv r r1 ret retc retcn s s1 st stn xorn
    """,
    # IEC 61131-3 ed. 2, tables 22 to 31; function names are keywords by annex C. Conversions: see CONVERSION.
    "function of IEC 61131-3": """
        abs acos add asin atan atan2 concat concat_date_tod cos delete div divtime eq exp expt find ge gt insert le
        left len limit ln log lt max mid min move mul multime mux ne replace right rol ror round sel shl shr sin sqrt
        sub tan trunc add_time add_tod_time add_dt_time sub_time sub_date_date sub_tod_time sub_tod_tod sub_dt_time
        sub_dt_dt day_of_week is_valid is_valid_bcd split_date split_tod split_dt
    """,
    # IEC 61131-3 ed. 2, tables 34 to 37; function block names are keywords by annex C.
    "function block of IEC 61131-3": """
        rs sr sema r_trig f_trig ctu ctd ctud ctu_dint ctu_lint ctu_udint ctu_ulint ctd_dint ctd_lint ctd_udint
        ctd_ulint ctud_dint ctud_lint ctud_ulint tp ton tof rtc tp_time tp_ltime ton_time ton_ltime tof_time tof_ltime
    """,
    # IEC 61131-3 ed. 2, annex F (examples); the compiler of OpenPLC and Beremiz (matiec, lib/ieclib.txt) knows
    # derivative, hysteresis, integral, pid and ramp before it reads a file.
    "function block of an annex of IEC 61131-3": """
        alrm_int analog_monitor average cmd_monitor delay derivative diffeq fwd_rev_mon hysteresis integral lag1
        limits_alarm pid ramp stack_int weigh debounce gravel mix_2_brix
    """,
    # CODESYS online help, "Keywords", "Operators" and compiler error C0543; TwinCAT 3 infosys, "Keywords".
    "keyword of CODESYS or TwinCAT": """
        adr adrinst and_then any_derived bit bitadr char_to end_property goto indexof ini params persistent pointer
        printf property reference sizeof test test_and_set to_char to_wchar union uxint var_generic var_inst var_stat
        wchar_to xint xlint xlword xsizeof xword or_else boolean
    """,
    # CODESYS libraries Standard and Util, lists of the online help; Util's ERROR, PERIOD and POINT are found in its
    # name space only.
    "function or function block of CODESYS": """
        base64 bit_as_byte bit_as_dword bit_as_word blink byte_as_bit charcurve derivative dword_as_bit extract
        freq_measure gen gen_mode getbit hysteresis integral limitalarm lin_trafo pack pd pid pid_fixcycle pt_size
        putbit ramp_int ramp_real setbit statistics_int statistics_real switchbit textblocksize unpack variance
        word_as_bit word_as_string wconcat wdelete wfind winsert wleft wlen wmid wreplace wright
    """,
    # TwinCAT 3 infosys, Tc2_Standard, Tc2_System and Tc2_Utilities; those that begin with F_ and FB_ left out.
    "function or function block of TwinCAT": """
        adslogdint adslogeventfb adslogstr adsread adswrite adsrdwrt adsrdstate adswrtctl bcd_to_dint clearbit32
        csetbit32 getbit32 setbit32 dcf77_time dcf77_time_ex drand frac getcurtaskindex getcputaccount getsystemtime
        guidsequalbyval isfinite lmod ltrunc memcmp memcpy memmove memset modabs profiler rtc_ex rtc_ex2 scopeserver
        tc_config tc_cpuusage tc_restart tc_stop tc_syslatency testandset writepersistentdata floor modturns
    """,
    # S7-SCL for S7-300/400 (manual of the language), "Keywords"; STEP 7 (TIA Portal) help, "Basic instructions" and
    # "Extended instructions" of SCL, for S7-1200 and S7-1500.
    "keyword or instruction of SCL": """
        blkmov block_db block_fb block_fc block_sdb block_sfb block_sfc calculate ceil chars_to_strg counter
        countofelements data_block deca deco dec dis_airt en_airt enco end_const end_data_block end_label
        end_organization_block end_region fill fill_blk floor frac gather gather_blk get_diag get_err_id get_error
        getblockname getinstancename getinstancepath getsymbolname goto hta ath inc is_array is_null jmp_list label
        lead_lag lower_bound max_len mc_halt mc_home mc_power mc_reset move_blk move_blk_variant neg nil norm_x
        not_null organization_block peek peek_bool poke poke_blk poke_bool program_alarm rd_loc_t rd_sys_t re_trigr
        region runtime s5time s_comp s_conv s_move scale scale_x scatter scatter_blk serialize deserialize sqr
        strg_to_chars strg_val swap switch t_add t_combine t_conv t_diff t_sub timer title tonr typeof typeofdb
        typeofelements umove_blk unscale upper_bound val_strg variant variant_to_db_any version void wr_loc_t wr_sys_t
        reset_timer preset_timer set_cint seg len ror rol const
    """,
    # Rockwell 1756-RM003 (general), 1756-RM006 (process control and drives), 1756-PM007 (structured text): operators,
    # functions and instructions of Logix; EnableIn and EnableOut are parameters of every add-on instruction.
    "keyword or instruction of Logix": """
        acl acb acs act afi alm alma almd ards arl asn atn ave awa awt bsl bsr btdt btd clr cmp concat cop cpt cps ctu
        dedt deg delete derv dff dtos dtr d2sd d3sd enablein enableout eot esel event fal fbc ffl ffu fgen find fll
        for frd fsc ger grt gsv hll hpf insert intg iot jkff jsr ldlg leq les lfl lfu lower lpf mave maxc meq mid minc
        mstd msg mvm mvmt nop not ntch onr ons osf osfi osr osri ote otl otu pi pide pmul posp rad res resd ret rlim
        rmps rto rtor rtos sbr scl scrv size sneg soc sqi sql sqo sqr srt srtp ssum ssv std stod stor swpb tnd tofr
        tot trn uid uie upper updn xic xio xpy abl ahl ard cc ddt end imc ldl2 mmc neq equ geq pcmd pclf pdet pfl povr
        ppd prnp psc pxrq
    """,
    # ISO/IEC 9899:1999, 6.4.1 (keywords); _Bool and its like cannot be names of ours.
    "keyword of C": """
        auto break case char const continue default do double else enum extern float for goto if inline int long
        register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
        asm
    """,
    # ISO/IEC 9899:1999, 7.12, 7.16, 7.18 (math.h, stdbool.h, stdint.h, which the exported C includes), and the macros
    # of other headers; other library functions do not meet members of structures (6.2.3, name spaces). p, s, i and o
    # are the arguments of the step function, lesser and greater its helpers.
    "name of the C library": """
        bool true false acosh asinh atanh cbrt copysign cosh erf erfc exp2 expm1 fabs fabsf fdim fma fmax fmin fmod
        fpclassify frexp hypot huge_val ilogb infinity isfinite isgreater isinf isless isnan isnormal isunordered j0
        j1 jn ldexp lgamma llrint llround log10 log1p log2 logb lrint lround math_errhandling modf nan nearbyint
        nextafter nexttoward pow remainder remquo rint scalbln scalbn signbit sinh tanh tgamma y0 y1 yn gamma drem
        significand assert complex imaginary eof errno main null offsetof setjmp stdin stdout stderr unix linux p s i
        o lesser greater
    """,
    "device of Windows, which no file can be called after": " ".join(name for name in DEVICES if name.isalnum()),
}
WORDS: dict[str, str] = {word: group for group, words in reversed(GROUPS.items()) for word in words.split()}

# IEC 61131-3 ed. 2, table 22 (INT_TO_REAL, TRUNC_REAL_INT, BCD_TO_INT, ..), ed. 3 TO_REAL; Tc2_Utilities and Util name
# theirs alike (BYTE_TO_GRAY, LREAL_TO_FMTSTR).
_TYPE = f"(?:{'|'.join(TYPES.split())})"
_FORM = f"(?:{_TYPE}|bcd|gray|decstr|hexstr|binstr|octstr|fmtstr|hexinascii|systemtime|filetime)"
CONVERSION = re.compile(rf"{_FORM}_to_{_FORM}|to_{_TYPE}|{_TYPE}_trunc_{_TYPE}|trunc_{_TYPE}(?:_{_TYPE})?")


def why_reserved(name: str) -> str | None:
    """What a name is already, e.g. "function block of an annex of IEC 61131-3"; None for one that is free.

    Examples
    --------
    >>> why_reserved("Ramp")
    'function block of an annex of IEC 61131-3'
    >>> why_reserved("int_to_real")
    'conversion of IEC 61131-3'
    >>> why_reserved("AUX")
    'device of Windows, which no file can be called after'
    >>> why_reserved("ramp_step")
    """
    word = name.lower()
    if CONVERSION.fullmatch(word):
        return "conversion of IEC 61131-3"
    return WORDS.get(word)
