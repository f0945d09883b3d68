! qless for Fortran: the functions of qless.h as subroutines whose last argument is ierr. Indices are integer(c_int32_t) and count from 1.
!
!     call qless_analyse(dofs, starts, columns, values, rhs, prescribed, prescribed_values, analysis, ierr)
!     call qless_eliminate(analysis, elimination, ierr)
!     call qless_expand(elimination, masters, u, ierr)
!
! ierr is 0, 1 if the verdict is ambiguous, 2 if constraints of a deck were left out, or negative; qless_message() then has the text.
module qless
    use, intrinsic :: iso_c_binding
    implicit none
    private
    public :: qless_analyse, qless_counts, qless_kinds, qless_explain, qless_free_analysis
    public :: qless_eliminate, qless_sizes, qless_dofs, qless_t, qless_g, qless_refresh, qless_free_elimination
    public :: qless_expand, qless_restrict, qless_multipliers, qless_reactions, qless_message
    public :: qless_fixed, qless_reason, qless_repairs, qless_repair, qless_doubt, qless_label
    public :: qless_condensed, qless_condensed_for_elements, qless_pattern_arrays, qless_condense, qless_assemble
    public :: qless_add_element, qless_free_pattern
    public :: qless_read_deck, qless_deck_warnings, qless_analyse_deck, qless_clean_deck, qless_free_deck

    integer(c_int), parameter, public :: qless_equation = 0, qless_dof = 1, qless_prescribed = 2
    integer(c_int), parameter, public :: qless_by_rows = 0, qless_by_columns = 1
    integer(c_int), parameter, public :: qless_full = 0, qless_lower = 1, qless_upper = 2
    integer(c_int), parameter, public :: qless_eliminated = 0, qless_kept = 1

    type, public :: qless_analysis
        type(c_ptr) :: handle = c_null_ptr
    end type
    type, public :: qless_elimination
        type(c_ptr) :: handle = c_null_ptr
    end type
    type, public :: qless_pattern
        type(c_ptr) :: handle = c_null_ptr
    end type
    type, public :: qless_deck
        type(c_ptr) :: handle = c_null_ptr
    end type
    ! coefficient times an equation, or times u_index = value.
    type, bind(c), public :: qless_member
        integer(c_int64_t) :: what, index
        real(c_double) :: coefficient
    end type
    ! Another right-hand side or prescribed value.
    type, bind(c), public :: qless_change
        integer(c_int64_t) :: what, index
        real(c_double) :: from, to
    end type

    abstract interface
        ! Adds K_e by rows (K_e(j, i) in Fortran) and f_e to arrays of zeros, on several threads at once; the result is 0.
        integer(c_int) function qless_element(context, element, matrix, forces) bind(c)
            import
            type(c_ptr), value :: context
            integer(c_int64_t), value :: element
            real(c_double), intent(inout) :: matrix(*), forces(*)
        end function
    end interface
    public :: qless_element

    interface
        integer(c_int) function c_analyse(m, n, base, starts, columns, values, rhs, count, dofs, given, options, analysis) &
            bind(c, name="qless_analyse")
            import
            integer(c_int64_t), value :: m, n, count
            integer(c_int), value :: base
            integer(c_int32_t), intent(in) :: starts(*), columns(*), dofs(*)
            real(c_double), intent(in) :: values(*), rhs(*), given(*)
            type(c_ptr), value :: options
            type(c_ptr) :: analysis
        end function
        integer(c_int) function c_free_analysis(analysis) bind(c, name="qless_analysis_free")
            import
            type(c_ptr), value :: analysis
        end function
        integer(c_int) function c_counts(analysis, equations, dofs, rank, redundant, conflicting) bind(c, name="qless_counts")
            import
            type(c_ptr), value :: analysis
            integer(c_int64_t) :: equations, dofs, rank, redundant, conflicting
        end function
        integer(c_int) function c_kinds(analysis, kinds, length) bind(c, name="qless_kinds")
            import
            type(c_ptr), value :: analysis
            integer(c_int8_t) :: kinds(*)
            integer(c_int64_t), value :: length
        end function
        integer(c_int) function c_explanation(analysis, row, rows, coefficients, room, count) bind(c, name="qless_explanation")
            import
            type(c_ptr), value :: analysis
            integer(c_int64_t), value :: row, room
            integer(c_int32_t) :: rows(*)
            real(c_double) :: coefficients(*)
            integer(c_int64_t) :: count
        end function
        integer(c_int) function c_eliminate(analysis, elimination) bind(c, name="qless_eliminate")
            import
            type(c_ptr), value :: analysis
            type(c_ptr) :: elimination
        end function
        integer(c_int) function c_free_elimination(elimination) bind(c, name="qless_elimination_free")
            import
            type(c_ptr), value :: elimination
        end function
        integer(c_int) function c_sizes(elimination, slaves, masters, prescribed, t_entries, g_entries) &
            bind(c, name="qless_sizes")
            import
            type(c_ptr), value :: elimination
            integer(c_int64_t) :: slaves, masters, prescribed, t_entries, g_entries
        end function
        integer(c_int) function c_dofs(elimination, slaves, masters, prescribed) bind(c, name="qless_dofs")
            import
            type(c_ptr), value :: elimination
            integer(c_int32_t) :: slaves(*), masters(*), prescribed(*)
        end function
        integer(c_int) function c_t(elimination, starts, columns, values) bind(c, name="qless_t")
            import
            type(c_ptr), value :: elimination
            integer(c_int32_t) :: starts(*), columns(*)
            real(c_double) :: values(*)
        end function
        integer(c_int) function c_g(elimination, g, length) bind(c, name="qless_g")
            import
            type(c_ptr), value :: elimination
            real(c_double) :: g(*)
            integer(c_int64_t), value :: length
        end function
        integer(c_int) function c_refresh(elimination, rhs, rhs_length, prescribed, prescribed_length) &
            bind(c, name="qless_refresh")
            import
            type(c_ptr), value :: elimination
            real(c_double), intent(in) :: rhs(*), prescribed(*)
            integer(c_int64_t), value :: rhs_length, prescribed_length
        end function
        integer(c_int) function c_expand(elimination, masters, masters_length, u, u_length) bind(c, name="qless_expand")
            import
            type(c_ptr), value :: elimination
            real(c_double), intent(in) :: masters(*)
            real(c_double) :: u(*)
            integer(c_int64_t), value :: masters_length, u_length
        end function
        integer(c_int) function c_restrict(elimination, forces, forces_length, masters, masters_length) &
            bind(c, name="qless_restrict")
            import
            type(c_ptr), value :: elimination
            real(c_double), intent(in) :: forces(*)
            real(c_double) :: masters(*)
            integer(c_int64_t), value :: forces_length, masters_length
        end function
        integer(c_int) function c_multipliers(elimination, residual, residual_length, lambda, lambda_length) &
            bind(c, name="qless_multipliers")
            import
            type(c_ptr), value :: elimination
            real(c_double), intent(in) :: residual(*)
            real(c_double) :: lambda(*)
            integer(c_int64_t), value :: residual_length, lambda_length
        end function
        integer(c_int) function c_reactions(elimination, residual, residual_length, lambda, lambda_length, reactions, length) &
            bind(c, name="qless_reactions")
            import
            type(c_ptr), value :: elimination
            real(c_double), intent(in) :: residual(*), lambda(*)
            real(c_double) :: reactions(*)
            integer(c_int64_t), value :: residual_length, lambda_length, length
        end function
        integer(c_int) function c_fixed(analysis, dofs, values, room, count) bind(c, name="qless_fixed")
            import
            type(c_ptr), value :: analysis
            integer(c_int32_t) :: dofs(*)
            real(c_double) :: values(*)
            integer(c_int64_t), value :: room
            integer(c_int64_t) :: count
        end function
        integer(c_int) function c_reason(analysis, what, index, members, room, rhs, irreducible, count) bind(c, name="qless_reason")
            import
            type(c_ptr), value :: analysis
            integer(c_int), value :: what
            integer(c_int64_t), value :: index, room
            type(qless_member) :: members(*)
            real(c_double) :: rhs
            integer(c_int) :: irreducible
            integer(c_int64_t) :: count
        end function
        integer(c_int) function c_repairs(analysis, groups) bind(c, name="qless_repairs")
            import
            type(c_ptr), value :: analysis
            integer(c_int64_t) :: groups
        end function
        integer(c_int) function c_repair_sizes(analysis, group, conflicts, ways, changes) bind(c, name="qless_repair_sizes")
            import
            type(c_ptr), value :: analysis
            integer(c_int64_t), value :: group
            integer(c_int64_t) :: conflicts, ways, changes
        end function
        integer(c_int) function c_repair_conflicts(analysis, group, rows, length) bind(c, name="qless_repair_conflicts")
            import
            type(c_ptr), value :: analysis
            integer(c_int64_t), value :: group, length
            integer(c_int64_t) :: rows(*)
        end function
        integer(c_int) function c_repair(analysis, group, way, changes, length) bind(c, name="qless_repair")
            import
            type(c_ptr), value :: analysis
            integer(c_int64_t), value :: group, way, length
            type(qless_change) :: changes(*)
        end function
        integer(c_int) function c_doubt(analysis, doubt, text, room, length) bind(c, name="qless_doubt")
            import
            type(c_ptr), value :: analysis
            integer(c_int) :: doubt
            character(kind=c_char) :: text(*)
            integer(c_int64_t), value :: room
            integer(c_int64_t) :: length
        end function
        integer(c_int) function c_label(analysis, what, index, text, room, length) bind(c, name="qless_label")
            import
            type(c_ptr), value :: analysis
            integer(c_int), value :: what
            integer(c_int64_t), value :: index, room
            character(kind=c_char) :: text(*)
            integer(c_int64_t) :: length
        end function
        integer(c_int) function c_condensed(elimination, dofs, lines, storage, prescribed, starts, index, pattern) &
            bind(c, name="qless_condensed")
            import
            type(c_ptr), value :: elimination
            integer(c_int64_t), value :: dofs
            integer(c_int), value :: lines, storage, prescribed
            integer(c_int32_t), intent(in) :: starts(*), index(*)
            type(c_ptr) :: pattern
        end function
        integer(c_int) function c_of_elements(elimination, elements, storage, prescribed, starts, dofs, pattern) &
            bind(c, name="qless_condensed_for_elements")
            import
            type(c_ptr), value :: elimination
            integer(c_int64_t), value :: elements
            integer(c_int), value :: storage, prescribed
            integer(c_int32_t), intent(in) :: starts(*), dofs(*)
            type(c_ptr) :: pattern
        end function
        integer(c_int) function c_free_pattern(pattern) bind(c, name="qless_pattern_free")
            import
            type(c_ptr), value :: pattern
        end function
        integer(c_int) function c_pattern_sizes(pattern, unknowns, entries) bind(c, name="qless_pattern_sizes")
            import
            type(c_ptr), value :: pattern
            integer(c_int64_t) :: unknowns, entries
        end function
        integer(c_int) function c_pattern_arrays(pattern, starts, index, dofs) bind(c, name="qless_pattern_arrays")
            import
            type(c_ptr), value :: pattern
            integer(c_int32_t) :: starts(*), index(*), dofs(*)
        end function
        integer(c_int) function c_condense(pattern, k, k_length, f, f_length, kq, kq_length, fq, fq_length) &
            bind(c, name="qless_condense")
            import
            type(c_ptr), value :: pattern
            real(c_double), intent(in) :: k(*), f(*)
            real(c_double) :: kq(*), fq(*)
            integer(c_int64_t), value :: k_length, f_length, kq_length, fq_length
        end function
        integer(c_int) function c_assemble(pattern, element, context, kq, kq_length, fq, fq_length) bind(c, name="qless_assemble")
            import
            type(c_ptr), value :: pattern, context
            type(c_funptr), value :: element
            real(c_double) :: kq(*), fq(*)
            integer(c_int64_t), value :: kq_length, fq_length
        end function
        integer(c_int) function c_add_element(pattern, count, dofs, matrix, forces, kq, kq_length, fq, fq_length) &
            bind(c, name="qless_add_element")
            import
            type(c_ptr), value :: pattern
            integer(c_int64_t), value :: count, kq_length, fq_length
            integer(c_int32_t), intent(in) :: dofs(*)
            real(c_double), intent(in) :: matrix(*), forces(*)
            real(c_double) :: kq(*), fq(*)
        end function
        integer(c_int) function c_read_deck(path, solver, base, deck) bind(c, name="qless_deck_read")
            import
            character(kind=c_char), intent(in) :: path(*)
            type(c_ptr), value :: solver
            integer(c_int), value :: base
            type(c_ptr) :: deck
        end function
        integer(c_int) function c_free_deck(deck) bind(c, name="qless_deck_free")
            import
            type(c_ptr), value :: deck
        end function
        integer(c_int) function c_deck_counts(deck, equations, load_cases, warnings, left_out) bind(c, name="qless_deck_counts")
            import
            type(c_ptr), value :: deck
            integer(c_int64_t) :: equations, load_cases, warnings, left_out
        end function
        integer(c_int) function c_deck_warning(deck, warning, text, room, length) bind(c, name="qless_deck_warning")
            import
            type(c_ptr), value :: deck
            integer(c_int64_t), value :: warning, room
            character(kind=c_char) :: text(*)
            integer(c_int64_t) :: length
        end function
        integer(c_int) function c_analyse_deck(deck, load_case, options, analysis) bind(c, name="qless_deck_analyse")
            import
            type(c_ptr), value :: deck, options
            integer(c_int64_t), value :: load_case
            type(c_ptr) :: analysis
        end function
        integer(c_int) function c_clean_deck(deck, options, path, removed, written) bind(c, name="qless_deck_clean")
            import
            type(c_ptr), value :: deck, options
            character(kind=c_char), intent(in) :: path(*)
            integer(c_int64_t) :: removed, written
        end function
        type(c_ptr) function c_message() bind(c, name="qless_message")
            import
        end function
        integer(c_size_t) function c_strlen(text) bind(c, name="strlen")
            import
            type(c_ptr), value :: text
        end function
    end interface

contains

    ! Diagnoses C u = b: starts has one number more than there are equations.
    subroutine qless_analyse(dofs, starts, columns, values, rhs, prescribed, prescribed_values, analysis, ierr)
        integer(c_int64_t), intent(in) :: dofs
        integer(c_int32_t), intent(in), contiguous :: starts(:), columns(:), prescribed(:)
        real(c_double), intent(in), contiguous :: values(:), rhs(:), prescribed_values(:)
        type(qless_analysis), intent(out) :: analysis
        integer, intent(out) :: ierr
        integer(c_int64_t) :: equations, entries
        equations = size(starts, kind=c_int64_t) - 1
        entries = size(columns, kind=c_int64_t)
        ierr = -1
        if (equations < 0) return
        if (size(values) /= entries .or. size(rhs) /= equations .or. size(prescribed) /= size(prescribed_values)) return
        if (starts(equations + 1) /= entries + 1) return
        ierr = c_analyse(equations, dofs, 1_c_int, starts, columns, values, rhs, size(prescribed, kind=c_int64_t), prescribed, &
                         prescribed_values, c_null_ptr, analysis%handle)
    end subroutine

    subroutine qless_free_analysis(analysis, ierr)
        type(qless_analysis), intent(inout) :: analysis
        integer, intent(out) :: ierr
        ierr = c_free_analysis(analysis%handle)
        analysis%handle = c_null_ptr
    end subroutine

    subroutine qless_counts(analysis, equations, dofs, rank, redundant, conflicting, ierr)
        type(qless_analysis), intent(in) :: analysis
        integer(c_int64_t), intent(out) :: equations, dofs, rank, redundant, conflicting
        integer, intent(out) :: ierr
        ierr = c_counts(analysis%handle, equations, dofs, rank, redundant, conflicting)
    end subroutine

    ! 0 independent, 1 redundant, 2 conflicting.
    subroutine qless_kinds(analysis, kinds, ierr)
        type(qless_analysis), intent(in) :: analysis
        integer(c_int8_t), intent(out), contiguous :: kinds(:)
        integer, intent(out) :: ierr
        ierr = c_kinds(analysis%handle, kinds, size(kinds, kind=c_int64_t))
    end subroutine

    ! The equations of which a dependent one is a combination.
    subroutine qless_explain(analysis, row, rows, coefficients, ierr)
        type(qless_analysis), intent(in) :: analysis
        integer(c_int64_t), intent(in) :: row
        integer(c_int32_t), intent(out), allocatable :: rows(:)
        real(c_double), intent(out), allocatable :: coefficients(:)
        integer, intent(out) :: ierr
        integer(c_int64_t) :: count
        allocate (rows(0), coefficients(0))
        ierr = c_explanation(analysis%handle, row, rows, coefficients, 0_c_int64_t, count)
        if (ierr < 0) return
        deallocate (rows, coefficients)
        allocate (rows(count), coefficients(count))
        ierr = c_explanation(analysis%handle, row, rows, coefficients, count, count)
    end subroutine

    subroutine qless_eliminate(analysis, elimination, ierr)
        type(qless_analysis), intent(in) :: analysis
        type(qless_elimination), intent(out) :: elimination
        integer, intent(out) :: ierr
        ierr = c_eliminate(analysis%handle, elimination%handle)
    end subroutine

    subroutine qless_free_elimination(elimination, ierr)
        type(qless_elimination), intent(inout) :: elimination
        integer, intent(out) :: ierr
        ierr = c_free_elimination(elimination%handle)
        elimination%handle = c_null_ptr
    end subroutine

    subroutine qless_sizes(elimination, slaves, masters, prescribed, t_entries, g_entries, ierr)
        type(qless_elimination), intent(in) :: elimination
        integer(c_int64_t), intent(out) :: slaves, masters, prescribed, t_entries, g_entries
        integer, intent(out) :: ierr
        ierr = c_sizes(elimination%handle, slaves, masters, prescribed, t_entries, g_entries)
    end subroutine

    subroutine qless_dofs(elimination, slaves, masters, prescribed, ierr)
        type(qless_elimination), intent(in) :: elimination
        integer(c_int32_t), intent(out), allocatable :: slaves(:), masters(:), prescribed(:)
        integer, intent(out) :: ierr
        integer(c_int64_t) :: s, q, p, t, g
        ierr = c_sizes(elimination%handle, s, q, p, t, g)
        if (ierr < 0) return
        allocate (slaves(s), masters(q), prescribed(p))
        ierr = c_dofs(elimination%handle, slaves, masters, prescribed)
    end subroutine

    ! T in compressed rows.
    subroutine qless_t(elimination, starts, columns, values, ierr)
        type(qless_elimination), intent(in) :: elimination
        integer(c_int32_t), intent(out), allocatable :: starts(:), columns(:)
        real(c_double), intent(out), allocatable :: values(:)
        integer, intent(out) :: ierr
        integer(c_int64_t) :: s, q, p, t, g
        ierr = c_sizes(elimination%handle, s, q, p, t, g)
        if (ierr < 0) return
        allocate (starts(s + 1), columns(t), values(t))
        ierr = c_t(elimination%handle, starts, columns, values)
    end subroutine

    subroutine qless_g(elimination, g, ierr)
        type(qless_elimination), intent(in) :: elimination
        real(c_double), intent(out), contiguous :: g(:)
        integer, intent(out) :: ierr
        ierr = c_g(elimination%handle, g, size(g, kind=c_int64_t))
    end subroutine

    subroutine qless_refresh(elimination, rhs, prescribed, ierr)
        type(qless_elimination), intent(in) :: elimination
        real(c_double), intent(in), contiguous :: rhs(:), prescribed(:)
        integer, intent(out) :: ierr
        ierr = c_refresh(elimination%handle, rhs, size(rhs, kind=c_int64_t), prescribed, size(prescribed, kind=c_int64_t))
    end subroutine

    ! u = L u_q + u_0.
    subroutine qless_expand(elimination, masters, u, ierr)
        type(qless_elimination), intent(in) :: elimination
        real(c_double), intent(in), contiguous :: masters(:)
        real(c_double), intent(out), contiguous :: u(:)
        integer, intent(out) :: ierr
        ierr = c_expand(elimination%handle, masters, size(masters, kind=c_int64_t), u, size(u, kind=c_int64_t))
    end subroutine

    ! f_q = L^T f.
    subroutine qless_restrict(elimination, forces, masters, ierr)
        type(qless_elimination), intent(in) :: elimination
        real(c_double), intent(in), contiguous :: forces(:)
        real(c_double), intent(out), contiguous :: masters(:)
        integer, intent(out) :: ierr
        ierr = c_restrict(elimination%handle, forces, size(forces, kind=c_int64_t), masters, size(masters, kind=c_int64_t))
    end subroutine

    ! lambda of K u + C^T lambda = f from the residual f - K u.
    subroutine qless_multipliers(elimination, residual, lambda, ierr)
        type(qless_elimination), intent(in) :: elimination
        real(c_double), intent(in), contiguous :: residual(:)
        real(c_double), intent(out), contiguous :: lambda(:)
        integer, intent(out) :: ierr
        ierr = c_multipliers(elimination%handle, residual, size(residual, kind=c_int64_t), lambda, size(lambda, kind=c_int64_t))
    end subroutine

    ! Reactions C^T lambda - (f - K u) at the prescribed DOFs.
    subroutine qless_reactions(elimination, residual, lambda, reactions, ierr)
        type(qless_elimination), intent(in) :: elimination
        real(c_double), intent(in), contiguous :: residual(:), lambda(:)
        real(c_double), intent(out), contiguous :: reactions(:)
        integer, intent(out) :: ierr
        ierr = c_reactions(elimination%handle, residual, size(residual, kind=c_int64_t), lambda, size(lambda, kind=c_int64_t), &
                           reactions, size(reactions, kind=c_int64_t))
    end subroutine

    ! The free DOFs that the equations fix, and their values.
    subroutine qless_fixed(analysis, dofs, values, ierr)
        type(qless_analysis), intent(in) :: analysis
        integer(c_int32_t), intent(out), allocatable :: dofs(:)
        real(c_double), intent(out), allocatable :: values(:)
        integer, intent(out) :: ierr
        integer(c_int64_t) :: count
        allocate (dofs(0), values(0))
        ierr = c_fixed(analysis%handle, dofs, values, 0_c_int64_t, count)
        if (ierr < 0) return
        deallocate (dofs, values)
        allocate (dofs(count), values(count))
        ierr = c_fixed(analysis%handle, dofs, values, count, count)
    end subroutine

    ! Why an equation is dependent (what = qless_equation) or a DOF fixed (qless_dof); rhs is the right-hand side of the sum of the members.
    ! irreducible: 1 if no member can be left out, 0 if that is not known.
    subroutine qless_reason(analysis, what, index, members, rhs, irreducible, ierr)
        type(qless_analysis), intent(in) :: analysis
        integer(c_int), intent(in) :: what
        integer(c_int64_t), intent(in) :: index
        type(qless_member), intent(out), allocatable :: members(:)
        real(c_double), intent(out) :: rhs
        integer(c_int), intent(out) :: irreducible
        integer, intent(out) :: ierr
        integer(c_int64_t) :: count
        allocate (members(0))
        ierr = c_reason(analysis%handle, what, index, members, 0_c_int64_t, rhs, irreducible, count)
        if (ierr < 0) return
        deallocate (members)
        allocate (members(count))
        ierr = c_reason(analysis%handle, what, index, members, count, rhs, irreducible, count)
    end subroutine

    ! Number of groups of conflicts that are cured together.
    subroutine qless_repairs(analysis, groups, ierr)
        type(qless_analysis), intent(in) :: analysis
        integer(c_int64_t), intent(out) :: groups
        integer, intent(out) :: ierr
        ierr = c_repairs(analysis%handle, groups)
    end subroutine

    ! The conflicting equations of a group, and changes(:, w) that cure them, the most plausible way w first.
    subroutine qless_repair(analysis, group, conflicts, changes, ierr)
        type(qless_analysis), intent(in) :: analysis
        integer(c_int64_t), intent(in) :: group
        integer(c_int64_t), intent(out), allocatable :: conflicts(:)
        type(qless_change), intent(out), allocatable :: changes(:, :)
        integer, intent(out) :: ierr
        integer(c_int64_t) :: count, ways, length, w
        ierr = c_repair_sizes(analysis%handle, group, count, ways, length)
        if (ierr < 0) return
        allocate (conflicts(count), changes(length, ways))
        ierr = c_repair_conflicts(analysis%handle, group, conflicts, count)
        do w = 1, ways
            if (ierr < 0) return
            ierr = c_repair(analysis%handle, group, w, changes(:, w), length)
        end do
    end subroutine

    ! Why the verdict is ambiguous: 0 or the number of a doubt in qless.h, and a line for each reason.
    subroutine qless_doubt(analysis, doubt, text, ierr)
        type(qless_analysis), intent(in) :: analysis
        integer, intent(out) :: doubt, ierr
        character(len=:), intent(out), allocatable :: text
        integer(c_int) :: number
        integer(c_int64_t) :: length
        character(kind=c_char) :: none(1)
        character(kind=c_char), allocatable :: bytes(:)
        ierr = c_doubt(analysis%handle, number, none, 0_c_int64_t, length)
        if (ierr < 0) return
        allocate (bytes(length))
        ierr = c_doubt(analysis%handle, number, bytes, length, length)
        doubt = number
        text = joined(bytes)
    end subroutine

    ! The label of an equation (what = qless_equation) or DOF (qless_dof), or the place of a prescribed value (qless_prescribed).
    subroutine qless_label(analysis, what, index, text, ierr)
        type(qless_analysis), intent(in) :: analysis
        integer(c_int), intent(in) :: what
        integer(c_int64_t), intent(in) :: index
        character(len=:), intent(out), allocatable :: text
        integer, intent(out) :: ierr
        integer(c_int64_t) :: length
        character(kind=c_char) :: none(1)
        character(kind=c_char), allocatable :: bytes(:)
        ierr = c_label(analysis%handle, what, index, none, 0_c_int64_t, length)
        if (ierr < 0) return
        allocate (bytes(length))
        ierr = c_label(analysis%handle, what, index, bytes, length, length)
        text = joined(bytes)
    end subroutine

    ! The pattern of K_q = L^T K L for matrices K in compressed lines (qless_by_rows or qless_by_columns; qless_full, _lower or _upper;
    ! prescribed DOFs qless_eliminated or qless_kept).
    subroutine qless_condensed(elimination, lines, storage, prescribed, starts, index, pattern, ierr)
        type(qless_elimination), intent(in) :: elimination
        integer(c_int), intent(in) :: lines, storage, prescribed
        integer(c_int32_t), intent(in), contiguous :: starts(:), index(:)
        type(qless_pattern), intent(out) :: pattern
        integer, intent(out) :: ierr
        integer(c_int64_t) :: dofs
        dofs = size(starts, kind=c_int64_t) - 1
        ierr = -1
        if (dofs < 0) return
        if (starts(dofs + 1) /= size(index) + 1) return
        ierr = c_condensed(elimination%handle, dofs, lines, storage, prescribed, starts, index, pattern%handle)
    end subroutine

    ! The same for elements: element e has the DOFs dofs(starts(e):starts(e + 1) - 1).
    subroutine qless_condensed_for_elements(elimination, storage, prescribed, starts, dofs, pattern, ierr)
        type(qless_elimination), intent(in) :: elimination
        integer(c_int), intent(in) :: storage, prescribed
        integer(c_int32_t), intent(in), contiguous :: starts(:), dofs(:)
        type(qless_pattern), intent(out) :: pattern
        integer, intent(out) :: ierr
        integer(c_int64_t) :: elements
        elements = size(starts, kind=c_int64_t) - 1
        ierr = -1
        if (elements < 0) return
        if (starts(elements + 1) /= size(dofs) + 1) return
        ierr = c_of_elements(elimination%handle, elements, storage, prescribed, starts, dofs, pattern%handle)
    end subroutine

    subroutine qless_free_pattern(pattern, ierr)
        type(qless_pattern), intent(inout) :: pattern
        integer, intent(out) :: ierr
        ierr = c_free_pattern(pattern%handle)
        pattern%handle = c_null_ptr
    end subroutine

    ! Lines of K_q, and the DOF of each unknown.
    subroutine qless_pattern_arrays(pattern, starts, index, dofs, ierr)
        type(qless_pattern), intent(in) :: pattern
        integer(c_int32_t), intent(out), allocatable :: starts(:), index(:), dofs(:)
        integer, intent(out) :: ierr
        integer(c_int64_t) :: unknowns, entries
        ierr = c_pattern_sizes(pattern%handle, unknowns, entries)
        if (ierr < 0) return
        allocate (starts(unknowns + 1), index(entries), dofs(unknowns))
        ierr = c_pattern_arrays(pattern%handle, starts, index, dofs)
    end subroutine

    ! kq = L^T K L and fq = L^T (f - K u_0).
    subroutine qless_condense(pattern, k, f, kq, fq, ierr)
        type(qless_pattern), intent(in) :: pattern
        real(c_double), intent(in), contiguous :: k(:), f(:)
        real(c_double), intent(out), contiguous :: kq(:), fq(:)
        integer, intent(out) :: ierr
        ierr = c_condense(pattern%handle, k, size(k, kind=c_int64_t), f, size(f, kind=c_int64_t), kq, size(kq, kind=c_int64_t), &
                          fq, size(fq, kind=c_int64_t))
    end subroutine

    ! kq and fq from all elements of qless_condensed_for_elements; element gets context.
    subroutine qless_assemble(pattern, element, context, kq, fq, ierr)
        type(qless_pattern), intent(in) :: pattern
        procedure(qless_element) :: element
        type(c_ptr), intent(in) :: context
        real(c_double), intent(out), contiguous :: kq(:), fq(:)
        integer, intent(out) :: ierr
        ierr = c_assemble(pattern%handle, c_funloc(element), context, kq, size(kq, kind=c_int64_t), fq, size(fq, kind=c_int64_t))
    end subroutine

    ! Adds one element to kq and fq; matrix(j, i) is the entry of row i and column j.
    subroutine qless_add_element(pattern, dofs, matrix, forces, kq, fq, ierr)
        type(qless_pattern), intent(in) :: pattern
        integer(c_int32_t), intent(in), contiguous :: dofs(:)
        real(c_double), intent(in), contiguous :: matrix(:, :), forces(:)
        real(c_double), intent(inout), contiguous :: kq(:), fq(:)
        integer, intent(out) :: ierr
        ierr = -1
        if (any(shape(matrix) /= size(dofs)) .or. size(forces) /= size(dofs)) return
        ierr = c_add_element(pattern%handle, size(dofs, kind=c_int64_t), dofs, matrix, forces, kq, size(kq, kind=c_int64_t), &
                             fq, size(fq, kind=c_int64_t))
    end subroutine

    ! Reads a deck of CalculiX, Abaqus, Nastran or ANSYS for the default solver of its format.
    subroutine qless_read_deck(path, deck, ierr)
        character(len=*), intent(in) :: path
        type(qless_deck), intent(out) :: deck
        integer, intent(out) :: ierr
        ierr = c_read_deck(trim(path)//c_null_char, c_null_ptr, 1_c_int, deck%handle)
    end subroutine

    subroutine qless_free_deck(deck, ierr)
        type(qless_deck), intent(inout) :: deck
        integer, intent(out) :: ierr
        ierr = c_free_deck(deck%handle)
        deck%handle = c_null_ptr
    end subroutine

    ! The warnings, a line each; the first left_out of them name constraints that were left out.
    subroutine qless_deck_warnings(deck, text, left_out, ierr)
        type(qless_deck), intent(in) :: deck
        character(len=:), intent(out), allocatable :: text
        integer(c_int64_t), intent(out) :: left_out
        integer, intent(out) :: ierr
        integer(c_int64_t) :: equations, load_cases, warnings, length, w
        character(kind=c_char) :: none(1)
        character(kind=c_char), allocatable :: bytes(:)
        text = ""
        ierr = c_deck_counts(deck%handle, equations, load_cases, warnings, left_out)
        if (ierr < 0) return
        do w = 1, warnings
            ierr = c_deck_warning(deck%handle, w, none, 0_c_int64_t, length)
            if (ierr < 0) return
            if (allocated(bytes)) deallocate (bytes)
            allocate (bytes(length))
            ierr = c_deck_warning(deck%handle, w, bytes, length, length)
            text = text//joined(bytes)//new_line("a")
        end do
    end subroutine

    ! Diagnoses a load case; -1 for any, if all constrain the same.
    subroutine qless_analyse_deck(deck, load_case, analysis, ierr)
        type(qless_deck), intent(in) :: deck
        integer(c_int64_t), intent(in) :: load_case
        type(qless_analysis), intent(out) :: analysis
        integer, intent(out) :: ierr
        ierr = c_analyse_deck(deck%handle, load_case, c_null_ptr, analysis%handle)
    end subroutine

    ! Writes the deck with an independent set of constraints.
    subroutine qless_clean_deck(deck, path, removed, written, ierr)
        type(qless_deck), intent(in) :: deck
        character(len=*), intent(in) :: path
        integer(c_int64_t), intent(out) :: removed, written
        integer, intent(out) :: ierr
        ierr = c_clean_deck(deck%handle, c_null_ptr, trim(path)//c_null_char, removed, written)
    end subroutine

    ! A text of the library without its closing zero.
    pure function joined(bytes) result(text)
        character(kind=c_char), intent(in) :: bytes(:)
        character(len=size(bytes) - 1) :: text
        integer :: k
        do k = 1, len(text)
            text(k:k) = bytes(k)
        end do
    end function

    ! Why the last call of the library failed on this thread.
    function qless_message() result(message)
        character(len=:), allocatable :: message
        character(kind=c_char), pointer :: text(:)
        type(c_ptr) :: start
        integer :: k
        start = c_message()
        call c_f_pointer(start, text, [c_strlen(start)])
        allocate (character(len=size(text)) :: message)
        do k = 1, size(text)
            message(k:k) = text(k)
        end do
    end function
end module
