! qless for Fortran: the functions of qless.h as subroutines whose last argument is ierr. Indices are integer(c_int32_t) and count from 1.
!
!     call qless_analyse(dofs, starts, columns, values, rhs, prescribed, prescribed_values, analysis, ierr)
!     call qless_eliminate(analysis, elimination, ierr)
!     call qless_expand(elimination, masters, u, ierr)
!
! ierr is 0, 1 if the verdict is ambiguous, or negative; qless_message() then has the text.
module qless
    use, intrinsic :: iso_c_binding
    implicit none
    private
    public :: qless_analyse, qless_counts, qless_kinds, qless_explain, qless_free_analysis
    public :: qless_eliminate, qless_sizes, qless_dofs, qless_t, qless_g, qless_refresh, qless_free_elimination
    public :: qless_expand, qless_restrict, qless_multipliers, qless_message

    type, public :: qless_analysis
        type(c_ptr) :: handle = c_null_ptr
    end type
    type, public :: qless_elimination
        type(c_ptr) :: handle = c_null_ptr
    end type

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
